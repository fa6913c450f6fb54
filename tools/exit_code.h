// What the command's exit code says. Scripts rely on these: they never change.
#pragma once

namespace welkin::tool {

enum ExitCode : int {
  success = 0,
  bad_input = 1,  ///< a file or its pixels, or no memory or output device for the work
  bad_usage = 2,  ///< an unknown option, or a value that no input could make valid
};

}  // namespace welkin::tool
