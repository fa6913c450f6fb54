#include "cache/stored_chain.h"

#include <algorithm>
#include <utility>

#include "cache/byte_writer.h"
#include "cache/pixel_key.h"
#include "cache/result_key.h"
#include "specular/prefilter_plan.h"

namespace welkin::cache {
namespace {

/// What a mip's bits depend on beside the source and how its pixels are cleaned: see `Prefilter`.
ContentHash mip_key(const specular::PrefilterPlan& plan, const specular::MipPlan& mip,
                    const PrefilterOptions& options) {
  ByteWriter writer;
  writer.put(mip.size);
  writer.put(mip.roughness);
  writer.put(mip.copy ? "copy" : name(mip.method));
  if (!mip.copy && mip.method == PrefilterMethod::spectral) {
    // The narrowest lobe of the whole chain decides which texels are taken out, and a cubemap's rings.
    writer.put(plan.least_alpha);
    writer.put(plan.reach);
  }
  if (!mip.copy && mip.method == PrefilterMethod::sampled) {
    writer.put(options.size);  // the chain that the taps read has the size of mip 0
    writer.put(options.samples);
  }
  return hash_bytes(writer.bytes().data(), writer.bytes().size());
}

}  // namespace

std::vector<EntryName> mip_names(const ContentHash& source, const PrefilterOptions& options) {
  const specular::PrefilterPlan plan = specular::plan_prefilter(options);
  const ContentHash pixels = pixel_key(options.pixels);
  std::vector<EntryName> names;
  for (const specular::MipPlan& mip : plan.mips) {
    names.push_back(
        {EntryKind::specular_mip, result_key("specular mip", {source, pixels, mip_key(plan, mip, options)})});
  }
  return names;
}

StoredChain::StoredChain(const ContentHash& source, const PrefilterOptions& options)
    : options_(options),
      names_(mip_names(source, options)),
      chain_(std::max(1, options.size >> options.leave_out_sharp), static_cast<int>(names_.size())),
      mips_(names_.size()) {
  settle();
}

void StoredChain::settle() {
  const auto missing = [](const std::optional<MipRecord>& mip) { return !mip; };
  const auto first = std::find_if(mips_.begin(), mips_.end(), missing);
  const auto last = std::find_if(mips_.rbegin(), mips_.rend(), missing);
  first_missing_ = static_cast<std::size_t>(first - mips_.begin());
  end_missing_ = static_cast<std::size_t>(mips_.rend() - last);
}

PrefilterOptions StoredChain::missing() const {
  PrefilterOptions rest = options_;
  rest.leave_out_sharp += static_cast<int>(first_missing_);
  rest.leave_out_rough += static_cast<int>(names_.size() - end_missing_);
  return rest;
}

void StoredChain::take_over(PrefilteredSpecular made) {
  if (made.mips.size() == names_.size()) {
    chain_ = std::move(made.cubemap);
  } else {
    const float* const first = made.cubemap.face(0, 0);
    std::copy(first, first + made.cubemap.bytes() / sizeof(float), chain_.face(static_cast<int>(first_missing_), 0));
  }
  std::move(made.mips.begin(), made.mips.end(), mips_.begin() + static_cast<std::ptrdiff_t>(first_missing_));
  made_ = std::move(made);
}

std::string StoredChain::found_text() const {
  const std::size_t found = names_.size() - (end_missing_ > first_missing_ ? end_missing_ - first_missing_ : 0);
  if (found == 0) return {};
  if (complete()) return "found " + where_;
  return std::to_string(found) + " of " + std::to_string(names_.size()) + " mips found " + where_;
}

PrefilteredSpecular StoredChain::take() {
  PrefilteredSpecular whole;
  whole.cubemap = std::move(chain_);
  for (std::optional<MipRecord>& mip : mips_) whole.mips.push_back(std::move(*mip));
  whole.pixels.passes = std::move(made_.pixels.passes);
  if (const std::string found = found_text(); !found.empty()) {
    whole.pixels.passes.insert(whole.pixels.passes.begin(), {"cache", "reuse", found, milliseconds_});
  }
  whole.peak_bytes = made_.peak_bytes;
  return whole;
}

}  // namespace welkin::cache
