// Promises about the command and Windows' consoles: Ctrl-C and Ctrl-Break stop it as SIGINT does elsewhere.
#include "places.h"
#include "platform/windows_system.h"
#include "support/catch.h"
#include "tools/command.h"

namespace welkin::test {

TEST_CASE("command: Ctrl-Break stops a bake with the code of an interrupt and leaves no temporary file", "[command]") {
  if (GetConsoleCP() == 0 && !AllocConsole()) {
    WARN("there is no console here, and none can be made: no key can be pressed");
    return;
  }
  const TemporaryDirectory folder;
  const std::filesystem::path input = folder.path() / "large.pfm";
  write_pfm(input, 2048, 1024, grey_image(2048, 1024, 0.5F));
  const std::filesystem::path out = folder.path() / "out";
  const std::filesystem::path errors = folder.path() / "errors";
  SECURITY_ATTRIBUTES inherited{sizeof inherited, nullptr, TRUE};
  STARTUPINFOW start{};
  start.cb = sizeof start;
  start.dwFlags = STARTF_USESTDHANDLES;
  start.hStdError =
      CreateFileW(errors.c_str(), GENERIC_WRITE, platform::kSharedByAll, &inherited, CREATE_ALWAYS, 0, nullptr);
  std::wstring line = L"\"" + std::filesystem::path(WELKIN_COMMAND).native() + L"\" bake \"" + input.native() +
                      L"\" -o \"" + out.native() + L"\" --size 1024 --threads 1 --formats ktx2,env";
  PROCESS_INFORMATION started{};
  REQUIRE(CreateProcessW(nullptr, line.data(), nullptr, nullptr, TRUE, CREATE_NEW_PROCESS_GROUP, nullptr, nullptr,
                         &start, &started));
  CloseHandle(start.hStdError);
  Sleep(1500);
  REQUIRE(GenerateConsoleCtrlEvent(CTRL_BREAK_EVENT, started.dwProcessId));
  REQUIRE(WaitForSingleObject(started.hProcess, 60'000) == WAIT_OBJECT_0);
  DWORD code = 0;
  GetExitCodeProcess(started.hProcess, &code);
  CloseHandle(started.hThread);
  CloseHandle(started.hProcess);
  CHECK(code == 130);
  std::ifstream stream(errors);
  std::string said;
  std::getline(stream, said);
  CHECK(contains(said, "stopped (Interrupt)"));
  CHECK_FALSE(std::filesystem::exists(out / "manifest.json"));
  if (!std::filesystem::exists(out)) return;
  for (const auto& entry : std::filesystem::directory_iterator(out)) {
    CHECK_FALSE(contains(entry.path().filename().string(), ".part"));
  }
}

}  // namespace welkin::test
