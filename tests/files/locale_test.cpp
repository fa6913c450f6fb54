// Files' texts are read and written the same whatever the host's C++ locale is: one with a decimal comma and points
// between thousands, as in Germany, would read "0.25" as 0.
#include <clocale>
#include <filesystem>
#include <fstream>
#include <locale>
#include <string>
#include <vector>

#include "platform/thread.h"
#include "support/catch.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "welkin/welkin.hpp"

namespace welkin::test {
namespace {

class DecimalComma : public std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

/// For as long as it lives; of C's locale too, where the system has such a one.
class GermanHost {
 public:
  GermanHost() : before_(std::locale::global(std::locale(std::locale::classic(), new DecimalComma))) {
    for (const char* const name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8"}) {
      if (std::setlocale(LC_ALL, name) != nullptr) return;
    }
  }
  ~GermanHost() {
    std::locale::global(before_);
    std::setlocale(LC_ALL, "C");
  }
  GermanHost(const GermanHost&) = delete;
  GermanHost& operator=(const GermanHost&) = delete;

 private:
  std::locale before_;
};

void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::string bytes_of(const std::filesystem::path& path) {
  const std::vector<char> bytes = read_bytes(path);
  return {bytes.begin(), bytes.end()};
}

/// What a bake is told to do, and why, and what is said of arguments that cannot be.
std::string all_explanations() {
  const TestLatLong picture = make_lat_long(Content::smooth, 16, 8, 3);
  SceneNeeds needs;
  needs.glossy = RoughnessRange{0.25, 0.75};
  BakeOptions options;
  options.specular = PrefilterOptions{};
  options.specular->size = 16;
  std::string all = plan_text(plan(picture.view(), needs, options));
  const auto add_message = [&all](const auto& call) {
    try {
      call();
    } catch (const Error& error) {
      all += error.what();
    }
  };
  Atmosphere air = earth();
  air.aerosol_asymmetry = -0.9;
  add_message([&] { (void)precompute_sky(air); });
  add_message([] { (void)turn_about_y(2.5e6); });
  PrefilterOptions rough;
  rough.roughness = {0.0, 1.5};
  rough.mips = 2;
  add_message([&] { (void)prefilter_specular(make_lat_long(Content::smooth, 16, 8, 3).view(), rough); });
  return all;
}

/// What all parsers and writers of text make of some files, as text.
std::string all_texts(const TemporaryDirectory& folder) {
  std::string all;
  const auto add = [&all](double value) { all += std::to_string(static_cast<long long>(value * 1e9)) + ' '; };

  TextureOptions options;
  options.metadata = {{"welkin.roughness", "0 0.25 0.5 1"}};
  const std::filesystem::path ktx2 = folder.file("specular.ktx2");
  write_texture(ktx2, Cubemap(8, 4).views(), options);
  const StoredEnvironment stored = probe_environment(ktx2);
  for (const double roughness : stored.roughness) add(roughness);
  for (const std::string& note : stored.info.notes) all += note;

  std::string pixels(std::size_t{8} * 4 * 12, '\0');
  pixels[2] = '\x80';
  pixels[3] = '\x3f';
  const std::filesystem::path pfm = folder.file("a.pfm");
  write_text(pfm, "PF\n8 4\n-1.5\n" + pixels);
  add(project_file(pfm).radiance.at(0, 0).x);

  const std::filesystem::path hdr = folder.file("a.hdr");
  const TestLatLong picture = make_lat_long(Content::smooth, 16, 8, 3);
  write_environment(hdr, picture.view());
  std::string text = bytes_of(hdr);
  const std::size_t line = text.find("FORMAT=");
  write_text(hdr, text.substr(0, line) + "EXPOSURE=1.25\nPRIMARIES=0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329\n" +
                      text.substr(line));
  add(project_file(hdr).radiance.at(0, 0).x);

  const std::filesystem::path env = folder.file("a.env");
  write_babylon_environment(env, to_babylon(Cubemap(8, 4), project_file(hdr).radiance));
  all += bytes_of(env).substr(0, 700);
  add(project_file(env).radiance.at(0, 0).x);

  std::filesystem::create_directories(folder.file("root/proc/self"));
  std::filesystem::create_directories(folder.file("root/cg/a"));
  write_text(folder.file("root/proc/self/cgroup"), "0::/a\n");
  write_text(folder.file("root/proc/self/mountinfo"), "35 24 0:30 / /cg rw - cgroup2 cgroup2 rw\n");
  write_text(folder.file("root/cg/a/cpu.max"), "250000 100000\n");
  add(detail::quota_processors(folder.file("root")));
  return all;
}

}  // namespace

TEST_CASE("texts of files, plans and errors are the same to a host with a decimal comma", "[codec][locale]") {
  const TemporaryDirectory folder;
  const std::string here = all_texts(folder);
  CHECK(here.starts_with("0 250000000 500000000 1000000000 "));
  const std::string explained = all_explanations();
  CHECK(explained.find("-0.9") != std::string::npos);
  CHECK(explained.find("2500000") != std::string::npos);
  const GermanHost host;
  CHECK(all_texts(folder) == here);
  CHECK(all_explanations() == explained);
}

TEST_CASE("stored roughness that is not used is noted", "[codec][locale]") {
  const TemporaryDirectory folder;
  const std::filesystem::path path = folder.file("specular.ktx2");
  const auto stored_as = [&](const std::string& text, LevelContent content = LevelContent::automatic) {
    TextureOptions options;
    options.metadata = {{"welkin.roughness", text}};
    write_texture(path, Cubemap(8, 4).views(), options);
    return probe_environment(path, {}, content);
  };
  const auto notes = [](const StoredEnvironment& stored) {
    int count = 0;
    for (const std::string& note : stored.info.notes) count += note.find("roughness") != std::string::npos ? 1 : 0;
    return count;
  };
  CHECK(notes(stored_as("0 0.25 0.5 1")) == 0);
  for (const char* const text : {"0 0,25 0,5 1", "0 0.25 0.5", "0 0.5 0.25 1", "0 0.25 0.5 1.5", "0 0.25 0.5 1 x", "",
                                 "nan nan nan nan", "-1 0 0.5 1", "0 0.25 0.5 1e"}) {
    const StoredEnvironment stored = stored_as(text);
    INFO(text);
    CHECK(notes(stored) == 1);
    CHECK(stored.roughness == roughness_of_mips(RoughnessSchedule::linear, 4, 8));
  }
  CHECK(notes(stored_as("0 0.25 0.5 1", LevelContent::radiance)) == 1);
}

}  // namespace welkin::test
