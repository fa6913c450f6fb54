// Runs through a picture's rows in groups, side by side, with a bounded number of readers.
#pragma once

#include <functional>
#include <vector>

#include "codec/row_source.h"
#include "welkin/control.h"

namespace welkin::codec {

/// What one thread needs: made for its first group, kept for the next ones.
struct RowWorker {
  std::size_t index = 0;  ///< below jobs::worker_count(Placement::arena), nobody else's meanwhile
  std::unique_ptr<RowReader> reader;
  std::vector<float> rows;  ///< room for one group as RGB floats, if that was asked for
};

/// How a picture is cut: by its shape and its file's, never by the number of threads.
struct RowGroups {
  int rows = 1;                          ///< of each group but the last
  bool buffered = false;                 ///< whether workers bring room for a group's rows
  std::uint64_t memory_limit_bytes = 0;  ///< for all workers together
};

/// Rows for a group where nothing else decides: a multiple of the source's natural rows that is worth a task.
[[nodiscard]] int comfortable_group_rows(const RowSource& source);

/// Calls `work(worker, first_row, row_count)` once for every group, several at a time.
///
/// Small pictures, and those of which the workers of all threads would exceed the memory limit, are worked
/// through in the calling thread. Throws `Error`: limit_exceeded if a single worker would exceed it,
/// cancelled, and whatever reading throws.
void for_each_row_group(const RowSource& source, const RowGroups& groups, const Control& control,
                        const std::function<void(RowWorker&, int first_row, int row_count)>& work);

}  // namespace welkin::codec
