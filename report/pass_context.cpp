#include "report/pass_context.h"

#include "welkin/error.h"

namespace welkin::report {

void progress(const PassContext& context, std::size_t done, std::size_t of) {
  if (context.control.stop.stop_requested()) throw Error(ErrorCode::cancelled, "the report was cancelled");
  if (context.control.progress) context.control.progress(static_cast<double>(done) / static_cast<double>(of));
}

}  // namespace welkin::report
