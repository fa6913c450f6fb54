// What a pass is measured with.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "report/environment.h"
#include "report/measurement.h"
#include "report/peers.h"
#include "report/scale.h"
#include "report/stopwatch.h"
#include "welkin/control.h"

namespace welkin::report {

struct PassContext {
  const Scale& scale;
  Stopwatch stopwatch;
  const ReportEnvironment& environment;
  std::filesystem::path file;    ///< the environment as Radiance .hdr
  std::filesystem::path folder;  ///< for what passes and peers write
  const Peers& peers;
  Control control;  ///< progress of this pass
};

/// What a pass is and how it is measured.
struct PassRunner {
  Pass pass;
  double cost = 1.0;  ///< share of the report's time, for the progress bar alone
  std::function<std::vector<Measurement>(const PassContext& context)> measure;
};

/// Tells the context how far the pass has come. Throws `Error` (cancelled).
void progress(const PassContext& context, std::size_t done, std::size_t of);

}  // namespace welkin::report
