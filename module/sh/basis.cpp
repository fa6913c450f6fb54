#include "sh/basis.h"

#include "tables/basis_constants.h"

namespace welkin::sh {

void evaluate_basis(double x, double y, double z, int bands, double* values) noexcept {
  simd::for_each_basis_value(tables::basis_constants(), x, y, z, 1.0, bands,
                             [values](int index, double value) { values[index] = value; });
}

}  // namespace welkin::sh
