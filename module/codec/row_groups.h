// Runs through a picture's rows in groups, side by side, with a bounded number of readers.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "codec/row_source.h"
#include "welkin/control.h"

namespace welkin::codec {

/// How a picture is cut: by its shape and its file's, never by the number of threads.
struct RowGroups {
  int rows = 1;                          ///< of each group, but the last one of a section
  std::uint64_t memory_limit_bytes = 0;  ///< for decoding and the groups' rows, on all threads together
};

/// Some rows, decoded.
struct RowGroup {
  int first_row = 0;
  int row_count = 0;
  const float* rgb = nullptr;  ///< row_count x width x 3, valid during the call
  std::size_t worker = 0;      ///< below jobs::worker_count(Placement::arena), nobody else's meanwhile
};

/// Rows for a group where nothing else decides: a multiple of the source's natural rows that is worth a task.
[[nodiscard]] int comfortable_group_rows(const RowSource& source);

/// Decodes every group once and calls `work` with it, several at a time. Returns the time spent in decoding, summed
/// over threads.
///
/// Of a sequential source, groups are decoded one after the other and handed to whoever is free: the next one is
/// decoded while others are worked on. After an error nothing more is decoded there.
///
/// Each thread holds one group's rows, and one reader (sequential: one for each section instead). Small pictures,
/// and those of which all that would exceed the memory limit, are worked through in the calling thread.
/// Throws `Error`: limit_exceeded if even that would exceed it, cancelled; and whatever reading or `work` throws.
std::chrono::nanoseconds for_each_row_group(const RowSource& source, const RowGroups& groups, const Control& control,
                                            const std::function<void(const RowGroup&)>& work);

/// Decodes the whole picture straight to `rgb` (height x width x 3), several comfortable groups at a time. Throws as
/// above.
void read_all_rows(const RowSource& source, std::uint64_t memory_limit_bytes, const Control& control, float* rgb);

}  // namespace welkin::codec
