// The table step of the joint fit: for given weights D each view's table E_v solves a small least-squares
// problem. Internal to the fits, and the one header there that shows Eigen.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "importer/fit/matrix.h"

namespace loden::importer {

// Normal equations of one view, in double.
struct ViewProducts {
  Eigen::MatrixXd gram;   // M^T M, M = A_v D: k x k
  Eigen::MatrixXd cross;  // M^T B_v: k x lights
  double squares = 0;     // |B_v|^2
  int rows = 0;           // of M and B_v that were looked at
  // With a factor F of the data's shape: of each light's own M_l = diag(F_l) M; `gram` is their mean then.
  std::vector<Eigen::MatrixXd> grams;
  double error(const Eigen::MatrixXd& e) const;  // |M E - B_v|^2 of these rows, `e` = E_v^T
};
ViewProducts viewProducts(const Matrix& seen, const Matrix& block);
ViewProducts viewProducts(const Matrix& seen, const Matrix& block, const Matrix& factor);

// E_v^T, k x lights.
Eigen::MatrixXd solveView(const ViewProducts& p);

// Products of the columns i >= j of `m`, in column i (i + 1) / 2 + j: the distinct entries of each row's
// outer product.
Eigen::MatrixXd componentPairs(const Eigen::Ref<const Eigen::MatrixXd>& m);

}  // namespace loden::importer
