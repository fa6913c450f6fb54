#include "report/measurement.h"

#include <algorithm>
#include <iterator>

namespace welkin::report {

std::vector<Measurement> of_pass(const Report& report, const std::string& pass) {
  std::vector<Measurement> found;
  std::copy_if(report.measurements.begin(), report.measurements.end(), std::back_inserter(found),
               [&](const Measurement& measurement) { return measurement.pass == pass; });
  return found;
}

std::string label(const Measurement& measurement) {
  const std::string own = measurement.method + ", " + measurement.setting;
  return measurement.peer.empty() ? own : measurement.peer + ": " + own;
}

}  // namespace welkin::report
