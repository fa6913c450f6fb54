// Projections while the caller waits.
#include "c_interface/control.h"
#include "c_interface/environments.h"
#include "c_interface/error_status.h"
#include "c_interface/options.h"
#include "c_interface/projection_result.h"
#include "welkin/environment_file.h"
#include "welkin/projection.h"
#include "welkin/welkin.h"

using namespace welkin::c_interface;  // NOLINT(google-build-using-namespace): entries have no namespace to be in

welkin_status welkin_project_cubemap(const welkin_cubemap* mips, int32_t mip_count,
                                     const welkin_projection_options* options, const welkin_control* control,
                                     welkin_projection* projection) {
  return guarded([&] {
    const auto wanted = projection_options(options);
    require_room(projection, wanted.bands);
    write_projection(projection, welkin::project(cubemap_views(mips, mip_count), wanted, control_of(control)));
    return WELKIN_OK;
  });
}

welkin_status welkin_project_lat_long(const welkin_lat_long* lat_long, const welkin_projection_options* options,
                                      const welkin_control* control, welkin_projection* projection) {
  return guarded([&] {
    const auto wanted = projection_options(options);
    require_room(projection, wanted.bands);
    write_projection(projection, welkin::project(lat_long_view(lat_long), wanted, control_of(control)));
    return WELKIN_OK;
  });
}

welkin_status welkin_project_file(const char* path, const welkin_read_options* read_options,
                                  const welkin_projection_options* options, const welkin_control* control,
                                  welkin_projection* projection) {
  return guarded([&] {
    require(path, "path");
    const auto wanted = projection_options(options);
    require_room(projection, wanted.bands);
    write_projection(projection, welkin::project_file(path, file_options(read_options), wanted, control_of(control)));
    return WELKIN_OK;
  });
}
