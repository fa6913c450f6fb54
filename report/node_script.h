// What Node.js is given to run.
#pragma once

namespace welkin::report {

/// node SCRIPT CONFIGURATION.json: projects a cubemap with Babylon.js and three.js and prints JSON. Its head says more.
extern const char* const kNodeScript;

}  // namespace welkin::report
