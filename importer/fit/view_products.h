// The table step of the joint fit: for given weights D each view's table E_v is the solution of a small
// least-squares problem. Internal to the fits; besides importer/fit/eigen.h the only header that exposes
// Eigen.
#pragma once

#include <Eigen/Core>

#include "importer/fit/matrix.h"

namespace loden::importer {

// The normal equations of one view, in double.
struct ViewProducts {
  Eigen::MatrixXd gram;                          // M^T M, M = A_v D: k x k
  Eigen::MatrixXd cross;                         // M^T B_v: k x lights
  double squares = 0;                            // |B_v|^2
  double error(const Eigen::MatrixXd& e) const;  // |M E - B_v|^2
};
ViewProducts viewProducts(const Matrix& seen, const Matrix& block);

// E_v^T, k x lights.
Eigen::MatrixXd solveView(const ViewProducts& p);

}  // namespace loden::importer
