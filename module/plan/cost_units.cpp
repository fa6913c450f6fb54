#include <array>

#include "welkin/cost_model.h"

namespace welkin {

std::span<const CostUnit> cost_units() noexcept {
  static constexpr std::array kUnits = {CostUnit{"clean_texel", &CostModel::clean_texel},
                                        CostUnit{"project_texel", &CostModel::project_texel},
                                        CostUnit{"project_sum", &CostModel::project_sum},
                                        CostUnit{"resample_texel", &CostModel::resample_texel},
                                        CostUnit{"resample_source", &CostModel::resample_source},
                                        CostUnit{"resample_cube_texel", &CostModel::resample_cube_texel},
                                        CostUnit{"resample_cube_source", &CostModel::resample_cube_source},
                                        CostUnit{"mip_texel", &CostModel::mip_texel},
                                        CostUnit{"copy_texel", &CostModel::copy_texel},
                                        CostUnit{"read_texel", &CostModel::read_texel},
                                        CostUnit{"read_plain_texel", &CostModel::read_plain_texel},
                                        CostUnit{"ring_texel", &CostModel::ring_texel},
                                        CostUnit{"bright_texel", &CostModel::bright_texel},
                                        CostUnit{"fourier_texel", &CostModel::fourier_texel},
                                        CostUnit{"legendre_term", &CostModel::legendre_term},
                                        CostUnit{"face_texel", &CostModel::face_texel},
                                        CostUnit{"tap", &CostModel::tap},
                                        CostUnit{"reference_pair", &CostModel::reference_pair},
                                        CostUnit{"reference_direction", &CostModel::reference_direction},
                                        CostUnit{"irradiance_term", &CostModel::irradiance_term},
                                        CostUnit{"irradiance_pair", &CostModel::irradiance_pair},
                                        CostUnit{"irradiance_direction", &CostModel::irradiance_direction},
                                        CostUnit{"brdf_texel", &CostModel::brdf_texel},
                                        CostUnit{"sheen_texel", &CostModel::sheen_texel},
                                        CostUnit{"transmittance_texel", &CostModel::transmittance_texel},
                                        CostUnit{"sun_path_node", &CostModel::sun_path_node},
                                        CostUnit{"first_order_node", &CostModel::first_order_node},
                                        CostUnit{"order_node", &CostModel::order_node},
                                        CostUnit{"scattered_once", &CostModel::scattered_once},
                                        CostUnit{"scattered_often", &CostModel::scattered_often},
                                        CostUnit{"slice_texel", &CostModel::slice_texel},
                                        CostUnit{"sky_direction", &CostModel::sky_direction},
                                        CostUnit{"projected_direction", &CostModel::projected_direction}};
  return kUnits;
}

}  // namespace welkin
