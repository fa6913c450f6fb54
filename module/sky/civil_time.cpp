// Dates as people write them.
#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "platform/float_environment.h"
#include "welkin/core.h"
#include "welkin/sky.h"

namespace welkin {
namespace {

/// Reads a date from the left.
class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text), rest_(text) {}

  [[noreturn]] void refuse(const std::string& why) const {
    throw Error(ErrorCode::invalid_argument,
                "the date \"" + std::string(text_.substr(0, 64)) + "\" " + why +
                    "; write it as 2026-06-21T18:30Z, 2026-06-21T18:30:15.5Z or 2026-06-21T20:30+02:00");
  }

  [[nodiscard]] bool skip(char c) {
    if (rest_.empty() || rest_.front() != c) return false;
    rest_.remove_prefix(1);
    return true;
  }
  void expect(char c) {
    if (!skip(c))
      refuse(std::string("lacks '") + c + "' where it ends or has \"" + std::string(rest_.substr(0, 8)) + '"');
  }

  /// So many digits, at most `highest`.
  int number(const char* what, std::size_t digits, int lowest, int highest) {
    int value = 0;
    for (std::size_t k = 0; k < digits; ++k) {
      if (k >= rest_.size() || rest_[k] < '0' || rest_[k] > '9') {
        refuse(std::string("has no ") + what + " of " + std::to_string(digits) + " digits");
      }
      value = 10 * value + (rest_[k] - '0');
    }
    rest_.remove_prefix(digits);
    if (value < lowest || value > highest) {
      refuse(std::string("has the ") + what + " " + std::to_string(value) + ", which must be from " +
             std::to_string(lowest) + " to " + std::to_string(highest));
    }
    return value;
  }

  /// What stands behind a decimal point; digits after the ninth count for nothing.
  double fraction() {
    double value = 0.0;
    double unit = 1.0;
    std::size_t digits = 0;
    for (; !rest_.empty() && rest_.front() >= '0' && rest_.front() <= '9'; rest_.remove_prefix(1), ++digits) {
      if (digits >= 9) continue;
      value = 10.0 * value + (rest_.front() - '0');
      unit *= 10.0;
    }
    if (digits == 0) refuse("has no digits behind its decimal point");
    return value / unit;
  }

  [[nodiscard]] bool at_end() const { return rest_.empty(); }

 private:
  std::string_view text_;
  std::string_view rest_;
};

int days_of_month(int year, int month) {
  constexpr std::array<int, 12> days{31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  const bool leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
  return days[static_cast<std::size_t>(month - 1)] + (month == 2 && leap ? 1 : 0);
}

/// Days from 1970-01-01, in the Gregorian calendar. Years begin in March, so that the leap day is their last.
int days_from_1970(int year, int month, int day) {
  // From March on months have 31, 30, 31, 30, 31 days again and again, 153 in five: (153 m + 2) / 5 days lie before
  // month m (March: 0). 719468 days lie between 0000-03-01 and 1970-01-01.
  const int shifted = month <= 2 ? year - 1 : year;
  const int of_year = (153 * (month > 2 ? month - 3 : month + 9) + 2) / 5 + day - 1;
  return 365 * shifted + shifted / 4 - shifted / 100 + shifted / 400 + of_year - 719468;
}

/// Minutes by which the zone is ahead of universal time.
int zone_minutes(Reader& reader) {
  if (reader.skip('Z') || reader.skip('z')) return 0;
  const bool ahead = reader.skip('+');
  if (!ahead && !reader.skip('-')) reader.refuse("has no time zone (Z, or hours and minutes such as +02:00)");
  const int hours = reader.number("zone's hour", 2, 0, 23);
  (void)reader.skip(':');
  const int minutes = 60 * hours + (reader.at_end() ? 0 : reader.number("zone's minute", 2, 0, 59));
  return ahead ? minutes : -minutes;
}

}  // namespace

double unix_seconds(std::string_view date) {
  const platform::FloatingPointScope floating_point;
  Reader reader(date);
  const int year = reader.number("year", 4, 1, 9999);
  reader.expect('-');
  const int month = reader.number("month", 2, 1, 12);
  reader.expect('-');
  const int day = reader.number("day", 2, 1, days_of_month(year, month));
  if (!reader.skip(' ') && !reader.skip('t')) reader.expect('T');
  const int hour = reader.number("hour", 2, 0, 23);
  reader.expect(':');
  const int minute = reader.number("minute", 2, 0, 59);
  int second = 0;
  double fraction = 0.0;
  if (reader.skip(':')) {
    second = reader.number("second", 2, 0, 60);
    if (reader.skip('.')) fraction = reader.fraction();
  }
  const int of_day = 60 * hour + minute - zone_minutes(reader);
  if (!reader.at_end()) reader.refuse("goes on behind its time zone");
  if (second == 60 && (of_day + 1440) % 1440 != 1439) {
    reader.refuse("has the second 60, a leap second, which is inserted only after 23:59:59 UTC");
  }
  return (days_from_1970(year, month, day) * 1440.0 + of_day) * 60.0 + second + fraction;
}

}  // namespace welkin
