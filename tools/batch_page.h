// The contact sheet of a batch.
#pragma once

#include <filesystem>
#include <string>

#include "tools/batch_merge.h"
#include "tools/batch_plan.h"

namespace welkin::tool {

/// By which a page is known for one of these.
inline constexpr const char* kPageTitle = "<title>Welkin batch</title>";

/// A page in HTML that needs nothing but the previews in the results. `folder`: where it will be.
[[nodiscard]] std::string batch_page(const BatchPlan& plan, const MergedBatch& merged,
                                     const std::filesystem::path& folder);

/// How a file in `folder` reaches another; with slashes.
[[nodiscard]] std::string link_from(const std::filesystem::path& folder, const std::filesystem::path& to);

}  // namespace welkin::tool
