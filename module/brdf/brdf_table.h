// A BRDF table filled by quadrature, row after row.
#pragma once

#include <cstddef>
#include <memory>

#include "welkin/brdf_table.h"
#include "welkin/control.h"

namespace welkin::brdf {

/// Throws `Error` (invalid_argument) for a size out of range.
void check_brdf(const BrdfTableOptions& options);

/// `brdf_table`; `made`: whether it had to be made.
[[nodiscard]] std::shared_ptr<const BrdfTable> shared_brdf(const BrdfTableOptions& options, const Control& control,
                                                           bool& made);

/// How many floats a table has.
[[nodiscard]] std::size_t brdf_values(const BrdfTableOptions& options) noexcept;

/// A new table, whatever is cached; options must have been checked. As `brdf_table` otherwise.
[[nodiscard]] std::shared_ptr<const BrdfTable> integrated_brdf(const BrdfTableOptions& options, const Control& control);

}  // namespace welkin::brdf
