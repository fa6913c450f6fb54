// What `welkin sky` can be asked.
#pragma once

#include <CLI/CLI.hpp>

#include "tools/bake_options.h"
#include "tools/sh_options.h"
#include "tools/sky_model.h"
#include "tools/sky_sweep.h"
#include "welkin/sky_harmonics.h"

namespace welkin::tool {

struct SkyOptions {
  SkyParameters sky;
  SkyHarmonicsOptions quadrature;
  ShOptions sh;  ///< threads, memory, bands, window, whose axes, form of the result
  bool print_atmosphere = false;

  bool wants_folder = false;  ///< -o
  BakeCommandOptions bake;
  int picture_height = 256;
  bool sun_disc = false;

  SweepOptions sweep;  ///< its path empty: no sweep
};

/// Adds all options to the command. `options` must outlive it.
void add_sky_options(CLI::App& command, SkyOptions& options);

/// What the options mean together; called once they are all read.
void settle(SkyOptions& options, const CLI::App& command);

}  // namespace welkin::tool
