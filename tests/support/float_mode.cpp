// Runs every test case in the floating-point environment that WELKIN_TEST_FLOAT_MODE names, as a caller would that has
// set it: without the variable in the default one.
#define CATCH_CONFIG_EXTERNAL_INTERFACES  // Catch2 2 shows listeners only so
#include <cstdlib>

#include "float_environment/modes.h"
#include "support/catch.h"

namespace welkin::test {
namespace {

#if __has_include(<catch2/catch_all.hpp>)
using Listener = Catch::EventListenerBase;
#else
using Listener = Catch::TestEventListenerBase;
#endif

class FloatMode final : public Listener {
 public:
  using Listener::Listener;

  void testCaseStarting(const Catch::TestCaseInfo& test) override {
    Listener::testCaseStarting(test);
    if (const char* const mode = std::getenv("WELKIN_TEST_FLOAT_MODE")) set_environment(mode_named(mode));
  }

  void testCaseEnded(const Catch::TestCaseStats& statistics) override {
    set_environment({});
    Listener::testCaseEnded(statistics);
  }
};

CATCH_REGISTER_LISTENER(FloatMode)

}  // namespace
}  // namespace welkin::test
