#include "c_interface/control.h"

#include <string>

#include "c_interface/error_status.h"

namespace welkin::c_interface {

Control control_of(const welkin_control* control) { return control == nullptr ? Control{} : control->control; }

}  // namespace welkin::c_interface

using namespace welkin::c_interface;  // NOLINT(google-build-using-namespace)

int32_t welkin_control_stop_requested(const welkin_control* control) {
  return control != nullptr && control->control.stop.stop_requested() ? 1 : 0;
}

welkin_status welkin_control_report_progress(const welkin_control* control, double done) {
  return guarded([&] {
    require(control, "control");
    if (!(done >= 0.0 && done <= 1.0)) refuse("done is " + std::to_string(done) + "; it must be from 0 to 1");
    if (control->control.progress) control->control.progress(done);
    return WELKIN_OK;
  });
}
