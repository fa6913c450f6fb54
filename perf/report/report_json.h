// A report as raw figures: JSON, which can be read again, and CSV.
#pragma once

#include <filesystem>
#include <string>

#include "perf/report/measurement.h"

namespace welkin::report {

/// {"format": "welkin report", "version": 1, "machine", "scale", "environment", "notes", "passes", "measurements":
/// [{pass, method, setting, error_rms, error_maximum, seconds, truth, peer, on_front}], "recommendations": [{pass,
/// target, method, setting} (null, null where none reaches it)]}. One line a measurement. A NaN is
/// null.
[[nodiscard]] std::string to_json(const Report& report);

/// Reads what `to_json` wrote; fronts and recommendations are not read, they follow from the rest. `name` is what
/// messages call it. Throws `Error`: corrupt_file (no JSON, or a member that is missing or of another type, named),
/// unsupported_file (another format or version).
[[nodiscard]] Report from_json(const std::string& text, const std::string& name);

/// Reads a file. Throws as `from_json`, and file_access; limit_exceeded for a file above 64 MiB.
[[nodiscard]] Report read_report(const std::filesystem::path& path);

/// pass,method,setting,peer,error_rms,error_maximum,seconds,on_front,truth: a header line, then a line a measurement
/// (RFC 4180).
[[nodiscard]] std::string to_csv(const Report& report);

}  // namespace welkin::report
