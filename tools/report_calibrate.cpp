#include "tools/report_calibrate.h"

#include "tools/needs_file.h"
#include "tools/progress_bar.h"
#include "welkin/cost_model.h"

namespace welkin::tool {

std::string report_costs(const std::string& file) {
  CostModel costs;
  {
    ProgressBar bar;
    costs = calibrate_costs(bar.control());
  }
  if (file.empty()) return json_text(costs_json(costs));
  save_costs(costs, file);
  return file + '\n';
}

}  // namespace welkin::tool
