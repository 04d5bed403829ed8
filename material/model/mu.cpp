#include "material/model/mu.h"

#include <algorithm>
#include <cmath>

namespace loden {

template <class T>
glm::vec<3, T> evaluateMean(const PhongMean& mean, const glm::vec<3, T>& wi, const glm::vec<3, T>& wo) {
  const glm::vec<3, T> sum = wi + wo;
  const T half_cosine = std::max(sum.z / std::sqrt(std::max(glm::dot(sum, sum), T(1e-12))), T(0));
  const T y =
      T(mean.ka) + T(mean.kd) * std::max(wi.z, T(0)) + T(mean.ks) * std::pow(half_cosine, T(mean.alpha));
  const T chroma_scale = mean.chroma == MeanChroma::kRatio ? y : T(1);
  return {y, T(mean.cb) * chroma_scale, T(mean.cr) * chroma_scale};
}

template glm::vec<3, float> evaluateMean(const PhongMean&, const glm::vec<3, float>&,
                                         const glm::vec<3, float>&);
template glm::vec<3, double> evaluateMean(const PhongMean&, const glm::vec<3, double>&,
                                          const glm::vec<3, double>&);

}  // namespace loden
