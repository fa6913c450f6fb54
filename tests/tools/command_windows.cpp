// Without a shell: its words are taken apart here, and nothing but words and 'quotes' is understood.
#include "platform/windows_system.h"
#include "support/catch.h"
#include "tools/command.h"

namespace welkin::test {
namespace {

/// The words of a line as a shell takes them, each in quotation marks. (No test's word ends in a backslash.)
std::wstring command_line(const std::string& line) {
  std::string words;
  char quote = '\0';
  bool inside = false;  // a word
  for (const char c : line) {
    if (quote == '\0' && (c == '<' || c == '>' || c == '|' || c == '$')) throw std::runtime_error("a shell is wanted");
    if (quote == '\0' && c == ' ') {
      if (inside) words += '"';
      inside = false;
      words += ' ';
      continue;
    }
    if (!inside) words += '"';
    inside = true;
    if (quote == '\0' && (c == '\'' || c == '"')) {
      quote = c;
    } else if (c == quote) {
      quote = '\0';
    } else {
      words += c == '"' ? std::string("\\\"") : std::string(1, c);
    }
  }
  if (inside) words += '"';
  return platform::path_of(words).native();
}

/// "A=B C=D", set while it lives.
class Variables {
 public:
  explicit Variables(const std::string& text) {
    for (std::size_t start = 0; start < text.size();) {
      const std::size_t end = std::min(text.find(' ', start), text.size());
      const std::string word = text.substr(start, end - start);
      const std::size_t equals = word.find('=');
      if (equals != std::string::npos) set(word.substr(0, equals), word.substr(equals + 1));
      start = end + 1;
    }
  }
  ~Variables() {
    for (const std::string& name : names_) SetEnvironmentVariableA(name.c_str(), nullptr);
  }
  Variables(const Variables&) = delete;
  Variables& operator=(const Variables&) = delete;

 private:
  void set(const std::string& name, const std::string& value) {
    SetEnvironmentVariableA(name.c_str(), value.c_str());
    names_.push_back(name);
  }

  std::vector<std::string> names_;
};

HANDLE inherited_file(const std::filesystem::path& path, DWORD access, DWORD disposition) {
  SECURITY_ATTRIBUTES inherited{sizeof inherited, nullptr, TRUE};
  return CreateFileW(path.c_str(), access, platform::kSharedByAll, &inherited, disposition, 0, nullptr);
}

}  // namespace

CommandResult run_program(const std::filesystem::path& program, const std::string& arguments,
                          const std::string& environment) {
  const TemporaryDirectory folder;
  const Variables set(environment);
  STARTUPINFOW start{};
  start.cb = sizeof start;
  start.dwFlags = STARTF_USESTDHANDLES;
  start.hStdInput = inherited_file("NUL", GENERIC_READ, OPEN_EXISTING);
  start.hStdOutput = inherited_file(folder.path() / "output", GENERIC_WRITE, CREATE_ALWAYS);
  start.hStdError = inherited_file(folder.path() / "errors", GENERIC_WRITE, CREATE_ALWAYS);
  std::wstring line = L'"' + program.native() + L"\" " + command_line(arguments);
  PROCESS_INFORMATION started{};
  const bool runs =
      CreateProcessW(nullptr, line.data(), nullptr, nullptr, TRUE, 0, nullptr, nullptr, &start, &started) != 0;
  for (const HANDLE file : {start.hStdInput, start.hStdOutput, start.hStdError}) CloseHandle(file);
  if (!runs) throw std::runtime_error(program.string() + " cannot be run");
  WaitForSingleObject(started.hProcess, INFINITE);
  DWORD code = 0;
  GetExitCodeProcess(started.hProcess, &code);
  CloseHandle(started.hThread);
  CloseHandle(started.hProcess);
  return {static_cast<int>(code), read_text(folder.path() / "output"), read_text(folder.path() / "errors")};
}

}  // namespace welkin::test
