// float_environment MODE FILE: calls every public function of the library in a caller's floating-point environment and
// writes a line for each: its name, and the bits of the results of a first and a second call. Each call must leave the
// caller's environment unchanged.
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>

#include "calls.h"

namespace welkin::test {

void Calls::leave(const char* name) {
  const FloatEnvironment left = current_environment();
  set_environment({});
  name_call("the test itself");
  if (left != mode_) complain(name, "changed the caller's floating-point environment");
}

void Calls::complain(const char* name, const char* what) {
  failed_ = true;
  std::fprintf(stderr, "%s %s\n", name, what);
}

std::string Calls::in_hexadecimal(std::uint64_t number) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(number));
  return text;
}

}  // namespace welkin::test

int main(int count, char** arguments) {
  using namespace welkin::test;
  if (count != 3) {
    std::fprintf(stderr, "usage: float_environment MODE FILE\n");
    return 2;
  }
  try {
    report_traps();
    Calls calls(mode_named(arguments[1]));
    call_harmonics(calls);
    call_images(calls);
    call_bakes(calls);
    call_skies(calls);
    call_files(calls);
    call_worker(calls);
    call_c(calls);
    std::ofstream file(arguments[2]);
    for (const std::string& line : calls.lines()) file << line << '\n';
    return calls.failed() || !file.flush() ? 1 : 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
