// Requests for files, and the sources made of a file's pixels.
#include <memory>
#include <utility>

#include "platform/text.h"
#include "welkin/bake_file.h"
#include "welkin/requests.h"

namespace welkin {

EnvironmentSource::EnvironmentSource(Environment environment) : EnvironmentSource(environment.view(), nullptr) {
  owner_ = std::shared_ptr<const float[]>(std::move(environment.pixels));
}

namespace {

template <class Request>
FileInput input_of(const Request& request) {
  return request.memory ? FileInput(*request.memory, platform::utf8(request.path)) : FileInput(request.path);
}

}  // namespace

Projection ProjectFile::operator()(const Control& control) const {
  return project_file(input_of(*this), read_options, options, control);
}

Environment ReadFile::operator()(const Control& control) const {
  return read_environment(input_of(*this), read_options, control);
}

EnvironmentStatistics MeasureFile::operator()(const Control& control) const {
  return measure_environment(input_of(*this), read_options, control);
}

std::shared_ptr<const BakeResult> BakeFile::operator()(const Control& control) const {
  return std::make_shared<const BakeResult>(bake_file(input_of(*this), read_options, options, control));
}

}  // namespace welkin
