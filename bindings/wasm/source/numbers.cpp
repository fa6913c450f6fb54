// Numbers as text and back, by JavaScript: the C library's own way, which computes with numbers of 128 bits, would be a
// seventh of the smallest module. Results are in no such text, only messages and the roughness in a file's metadata.
//
// These functions have the names of the C library's. The linker meets them first and takes that one's no more.
#include <locale.h>  // NOLINT(modernize-deprecated-headers): locale_t is not C++'s

#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>

namespace {

/// JavaScript's: `value` as printf writes it by `conversion` (f, e or g) to `text`, at most `room` characters; how many
/// it has.
extern "C" [[clang::import_module("welkin"), clang::import_name("number_text")]] int number_text(double value,
                                                                                                 int conversion,
                                                                                                 int precision,
                                                                                                 char* text, int room);
/// JavaScript's: the double that is nearest to a decimal number.
extern "C" [[clang::import_module("welkin"), clang::import_name("number_of")]] double number_of(const char* text,
                                                                                                int length);

bool is_digit(char character) { return character >= '0' && character <= '9'; }

const char* behind_digits(const char* at) {
  while (is_digit(*at)) ++at;
  return at;
}

/// Behind the decimal number at `text`; `text` where there is none.
const char* behind_number(const char* text) {
  const char* at = text;
  if (*at == '-' || *at == '+') ++at;
  const char* const whole = at;
  at = behind_digits(at);
  bool digits = at != whole;
  if (*at == '.') {
    const char* const behind = behind_digits(at + 1);
    digits = digits || behind != at + 1;
    at = behind;
  }
  if (!digits) return text;
  if (*at == 'e' || *at == 'E') {
    const char* exponent = at + 1;
    if (*exponent == '-' || *exponent == '+') ++exponent;
    if (is_digit(*exponent)) at = behind_digits(exponent);
  }
  return at;
}

/// What snprintf has written: no more than there is room for, but all of it is counted.
class Output {
 public:
  Output(char* text, std::size_t room) : text_(text), room_(room) {}

  void put(char character) {
    if (length_ + 1 < room_) text_[length_] = character;
    ++length_;
  }
  void put(const char* text, int characters) {
    for (int k = 0; k < characters; ++k) put(text[k]);
  }
  /// `digits` at least, in base 10 or 16.
  void put_whole(unsigned long long value, unsigned base, int digits) {
    char text[20];
    char* at = std::end(text);
    for (; value != 0 || digits > 0; value /= base, --digits) *--at = "0123456789ABCDEF"[value % base];
    put(at, static_cast<int>(std::end(text) - at));
  }
  int finish() {
    if (room_ > 0) text_[length_ < room_ ? length_ : room_ - 1] = '\0';
    return static_cast<int>(length_);
  }

 private:
  char* text_;
  std::size_t room_;
  std::size_t length_ = 0;
};

}  // namespace

/// Blanks, infinities, NaN and hexadecimal digits are no numbers here: nothing that is linked reads such.
extern "C" double strtod(const char* text, char** end) {
  const char* const behind = behind_number(text);
  if (end != nullptr) *end = const_cast<char*>(behind);
  return behind == text ? 0.0 : number_of(text, static_cast<int>(behind - text));
}

// Those of other precisions lie in the same source of the C library's, and the C++ library names them.
extern "C" float strtof(const char* text, char** end) { return static_cast<float>(strtod(text, end)); }
extern "C" long double strtold(const char* text, char** end) { return static_cast<long double>(strtod(text, end)); }
extern "C" float strtof_l(const char* text, char** end, locale_t /*locale*/) { return strtof(text, end); }
extern "C" double strtod_l(const char* text, char** end, locale_t /*locale*/) { return strtod(text, end); }
extern "C" long double strtold_l(const char* text, char** end, locale_t /*locale*/) { return strtold(text, end); }

/// Knows d, i, u, X, s, f, e and g, a precision, and no width or flags: nothing that is linked asks for more.
extern "C" int vsnprintf(char* text, std::size_t room, const char* format, std::va_list arguments) {
  Output output(text, room);
  for (; *format != '\0'; ++format) {
    if (*format != '%') {
      output.put(*format);
      continue;
    }
    int precision = -1;
    if (*++format == '.') {
      if (*++format == '*') {
        precision = va_arg(arguments, int);
        ++format;
      } else {
        precision = std::atoi(format);
        format = behind_digits(format);
      }
    }
    int longs = 0;
    for (; *format == 'l' || *format == 'z'; ++format) longs += *format == 'l' ? 1 : 0;
    const int digits = precision < 0 ? 1 : precision;
    switch (*format) {
      case 'd':
      case 'i': {
        const long long value = longs == 2 ? va_arg(arguments, long long) : va_arg(arguments, long);
        if (value < 0) output.put('-');
        const auto bits = static_cast<unsigned long long>(value);
        output.put_whole(value < 0 ? 0 - bits : bits, 10, digits);
        break;
      }
      case 'u':
      case 'X': {
        const unsigned base = *format == 'u' ? 10 : 16;
        output.put_whole(longs == 2 ? va_arg(arguments, unsigned long long) : va_arg(arguments, unsigned long), base,
                         digits);
        break;
      }
      case 's': {
        const char* const string = va_arg(arguments, const char*);
        output.put(string, static_cast<int>(std::strlen(string)));
        break;
      }
      case 'f':
      case 'e':
      case 'g': {
        constexpr int kUsual = 6;
        char number[512];  // the largest double takes 309 digits in front of its point
        output.put(number, number_text(va_arg(arguments, double), *format, precision < 0 ? kUsual : precision, number,
                                       sizeof number));
        break;
      }
      default: output.put(*format);
    }
  }
  return output.finish();
}

extern "C" int snprintf(char* text, std::size_t room, const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  const int length = vsnprintf(text, room, format, arguments);
  va_end(arguments);
  return length;
}
