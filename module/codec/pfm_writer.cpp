// PFM: little-endian floats, rows from bottom to top. Every value stays what it is.
#include <bit>
#include <string>
#include <vector>

#include "codec/output_picture.h"

namespace welkin::codec {

static_assert(std::endian::native == std::endian::little, "rows are written as they lie in memory");

std::uint64_t write_pfm(const OutputPicture& picture, const WriteJob& job) {
  const std::string header =
      "PF\n" + std::to_string(picture.width()) + " " + std::to_string(picture.height()) + "\n-1.0\n";
  job.file.write(header.data(), header.size());
  std::vector<float> row(std::size_t{3} * static_cast<std::size_t>(picture.width()));
  for (int done = 0; done < picture.height(); ++done) {
    report_rows(job, done, picture.height());
    picture.read_row(picture.height() - 1 - done, row.data());
    job.file.write(row.data(), row.size() * sizeof(float));
  }
  return 0;
}

}  // namespace welkin::codec
