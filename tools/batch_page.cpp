#include "tools/batch_page.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <system_error>

#include "platform/text.h"
#include "tools/bake_manifest.h"
#include "tools/json.h"
#include "tools/text.h"
#include "welkin/core.h"

namespace welkin::tool {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHead = R"(<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>Welkin batch</title>
<style>
body { margin: 2rem; font: 15px/1.45 system-ui, sans-serif; color: #222; background: #f6f6f4; }
h1 { font-size: 1.4rem; margin: 0 0 .3rem; }
p { margin: 0 0 1.2rem; }
code { font-size: .85em; }
main { display: grid; grid-template-columns: repeat(auto-fill, minmax(20rem, 1fr)); gap: 1rem; }
figure { margin: 0; background: #fff; border: 1px solid #ddd; border-radius: 6px; overflow: hidden; }
img { display: block; width: 100%; height: auto; background: #333; }
.none { display: grid; place-items: center; aspect-ratio: 2; background: #e9e9e6; color: #666; }
figcaption { padding: .6rem .8rem; overflow-wrap: anywhere; }
figcaption b { display: block; }
figcaption span { color: #555; font-size: .87em; }
@media (prefers-color-scheme: dark) {
  body { color: #ddd; background: #191919; }
  figure { background: #242424; border-color: #3a3a3a; }
  .none { background: #2e2e2e; color: #aaa; }
  figcaption span { color: #aaa; }
}
</style>
</head>
<body>
)";

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : printable(text)) {
    switch (c) {
      case '&': safe += "&amp;"; break;
      case '<': safe += "&lt;"; break;
      case '>': safe += "&gt;"; break;
      case '"': safe += "&quot;"; break;
      default: safe += c; break;
    }
  }
  return safe;
}

/// With percent signs for what means something in an address, or is no ASCII.
std::string address(const std::string& path) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-._~/";
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string safe;
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    if (kPlain.find(c) != std::string_view::npos) {
      safe += c;
    } else {
      safe += '%';
      safe += kDigits[byte >> 4U];
      safe += kDigits[byte & 15U];
    }
  }
  return safe;
}

/// Null if it is not there.
const Json* member(const Json& object, std::string_view name) {
  if (!object.is_object()) return nullptr;
  for (const auto& [key, value] : object.members()) {
    if (key == name) return &value;
  }
  return nullptr;
}

/// 0 if it is not there.
double number_of(const Json& object, std::string_view name) {
  const Json* const found = member(object, name);
  return found != nullptr && found->is_number() ? found->number() : 0.0;
}

std::string text_of(const Json& object, std::string_view name) {
  const Json* const found = member(object, name);
  return found != nullptr && found->is_text() ? found->text() : "";
}

std::string size_of(const Json& object, const char* width, const char* height) {
  return std::to_string(static_cast<long>(number_of(object, width))) + " x " +
         std::to_string(static_cast<long>(number_of(object, height)));
}

/// "1024 x 512 lat-long, OpenEXR"
std::string source_words(const Json& manifest) {
  const Json* const source = member(manifest, "source");
  if (source == nullptr) return "";
  return size_of(*source, "width", "height") + ' ' + text_of(*source, "layout") + ", " + text_of(*source, "format");
}

/// "specular 256, 5 mips, error about 0.0012"
std::string specular_words(const Json& manifest) {
  const Json* const mips = member(manifest, "specular");
  if (mips == nullptr || !mips->is_array() || mips->elements().empty()) return "";
  double worst = 0.0;
  for (const Json& mip : mips->elements()) worst = std::max(worst, number_of(mip, "error_estimate"));
  std::string text = "specular " + std::to_string(static_cast<long>(number_of(mips->elements().front(), "size"))) +
                     ", " + counted(mips->elements().size(), "mip");
  if (worst > 0.0) text += ", error about " + significant(worst, 2);
  return text;
}

std::string bytes_words(const ResultFiles& files) {
  constexpr double kKibi = 1024.0;
  std::uint64_t bytes = 0;
  for (const ResultFile& file : files) bytes += file.bytes;
  const double kibibytes = static_cast<double>(bytes) / kKibi;
  return counted(files.size(), "file") + ", " +
         (kibibytes < kKibi ? rough(kibibytes) + " KiB" : rough(kibibytes / kKibi) + " MiB");
}

Json manifest_in(const fs::path& result) {
  try {
    return read_json_file(result / kManifestName, "");
  } catch (const Error&) {
    return {};
  } catch (const Flaw&) {
    return {};
  }
}

std::string pictures(const MergedResult& result, const std::string& name, const fs::path& folder) {
  constexpr std::array<const char*, 2> kPreviews = {"preview_environment.png", "preview_spheres.png"};
  std::string text;
  for (const char* const preview : kPreviews) {
    if (std::ranges::find(result.files, preview, &ResultFile::name) == result.files.end()) continue;
    text += R"(<img loading="lazy" alt=")" + escaped(name) + R"(" src=")" +
            address(link_from(folder, result.folder / preview)) + "\">\n";
  }
  return text.empty() ? "<div class=\"none\">no previews</div>\n" : text;
}

std::string figure(const BatchJob& job, const MergedResult& result, const fs::path& folder) {
  if (result.is_missing) {
    return "<figure>\n<div class=\"none\">missing</div>\n<figcaption><b>" + escaped(job.name) + "</b><span>" +
           escaped(result.problem) + "</span></figcaption>\n</figure>\n";
  }
  const Json manifest = manifest_in(result.folder);
  std::string text = "<figure>\n" + pictures(result, job.name, folder) + "<figcaption><b>" + escaped(job.name) + "</b>";
  for (const std::string& words : {source_words(manifest), specular_words(manifest), bytes_words(result.files)}) {
    if (!words.empty()) text += "<span>" + escaped(words) + "</span><br>";
  }
  return text + "<a href=\"" + address(link_from(folder, result.folder)) + "/\"><code>" +
         escaped(platform::utf8(result.folder.filename())) + "</code></a></figcaption>\n</figure>\n";
}

}  // namespace

std::string link_from(const fs::path& folder, const fs::path& to) {
  std::error_code unknown;
  const fs::path from = fs::weakly_canonical(fs::absolute(folder, unknown), unknown);
  const fs::path target = fs::weakly_canonical(fs::absolute(to, unknown), unknown);
  std::string link = platform::utf8(target.lexically_proximate(from));
  if constexpr (fs::path::preferred_separator != '/') {
    std::ranges::replace(link, static_cast<char>(fs::path::preferred_separator), '/');
  }
  return link;
}

std::string batch_page(const BatchPlan& plan, const MergedBatch& merged, const fs::path& folder) {
  std::uint64_t bytes = 0;
  for (const MergedResult& result : merged.results) {
    for (const ResultFile& file : result.files) bytes += file.bytes;
  }
  constexpr unsigned kMebi = 20;
  std::string text = kHead;
  text += "<h1>" + escaped(platform::utf8(plan.file.filename())) + "</h1>\n<p>" +
          counted(plan.jobs.size(), "environment") + ", " + grouped(bytes >> kMebi) + " MiB; " +
          (merged.missing > 0 ? grouped(merged.missing) + " missing; " : "") +
          "every file has the hash that it was written with. The batch: <code>" + merged.hash().text() +
          "</code></p>\n<main>\n";
  for (std::size_t job = 0; job < plan.jobs.size(); ++job) {
    text += figure(plan.jobs[job], merged.results[job], folder);
  }
  return text + "</main>\n</body>\n</html>\n";
}

}  // namespace welkin::tool
