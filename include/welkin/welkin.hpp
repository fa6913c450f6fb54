// All of Welkin's C++ interface.
#pragma once

#include "welkin/analytic_sky.h"
#include "welkin/babylon.h"
#include "welkin/control.h"
#include "welkin/directional_light.h"
#include "welkin/environment_file.h"
#include "welkin/error.h"
#include "welkin/harmonic_transforms.h"
#include "welkin/image.h"
#include "welkin/image_view.h"
#include "welkin/instruction_set.h"
#include "welkin/irradiance.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"
#include "welkin/version.h"
#include "welkin/windowing.h"
