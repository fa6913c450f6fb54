#include "cache/entry_memory.h"

#include <utility>

namespace welkin::cache {

Payload EntryMemory::find(const EntryName& name) {
  const std::scoped_lock lock(mutex_);
  const auto place = places_.find(name);
  if (place == places_.end()) return nullptr;
  entries_.splice(entries_.begin(), entries_, place->second);
  return place->second->payload;
}

void EntryMemory::store(const EntryName& name, Payload payload) {
  if (payload->size() > bound_bytes_) return;
  const std::scoped_lock lock(mutex_);
  if (const auto place = places_.find(name); place != places_.end()) erase(place->second);
  bytes_ += payload->size();
  entries_.push_front({name, std::move(payload)});
  places_[name] = entries_.begin();
  while (bytes_ > bound_bytes_) erase(std::prev(entries_.end()));
}

void EntryMemory::remove(const EntryName& name) {
  const std::scoped_lock lock(mutex_);
  if (const auto place = places_.find(name); place != places_.end()) erase(place->second);
}

std::uint64_t EntryMemory::bytes() const {
  const std::scoped_lock lock(mutex_);
  return bytes_;
}

void EntryMemory::erase(std::list<Entry>::iterator entry) {
  bytes_ -= entry->payload->size();
  places_.erase(entry->name);
  entries_.erase(entry);
}

}  // namespace welkin::cache
