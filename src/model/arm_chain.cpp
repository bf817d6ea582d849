// The only source that sees Pinocchio.
#include "arm_chain.hpp"

#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/joint-configuration.hpp>
#include <pinocchio/algorithm/model.hpp>
#include <pinocchio/multibody.hpp>
#include <pinocchio/parsers/urdf.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include "ajar/core/error.hpp"

namespace ajar {
namespace {

Pose to_pose(const pinocchio::SE3& X) {
  Pose pose = Pose::Identity();
  pose.linear() = X.rotation();
  pose.translation() = X.translation();
  return pose;
}

pinocchio::FrameIndex body_frame(const pinocchio::Model& model, const std::string& name, const std::filesystem::path& urdf) {
  if (!model.existFrame(name, pinocchio::BODY)) {
    throw ModelError(urdf.string() + ": link " + name + ": missing");
  }
  return model.getFrameId(name, pinocchio::BODY);
}

pinocchio::Model arm_model(const std::filesystem::path& urdf, const std::vector<std::string>& joints) {
  pinocchio::Model full;
  pinocchio::urdf::buildModel(urdf.string(), full);
  std::vector<pinocchio::JointIndex> locked;
  for (pinocchio::JointIndex j = 1; j < static_cast<pinocchio::JointIndex>(full.njoints); ++j) {
    if (std::find(joints.begin(), joints.end(), full.names[j]) == joints.end()) {
      locked.push_back(j);
    }
  }
  return pinocchio::buildReducedModel(full, locked, pinocchio::neutral(full));
}

// Moves the origin of the model from the root of the URDF to the base frame, so that nothing is left to do at run time.
void move_origin(pinocchio::Model& model, const pinocchio::SE3& X_RB) {
  const pinocchio::SE3 X_BR = X_RB.inverse();
  for (std::size_t j = 1; j < static_cast<std::size_t>(model.njoints); ++j) {
    if (model.parents[j] == 0) {
      model.jointPlacements[j] = X_BR * model.jointPlacements[j];
    }
  }
  for (auto& frame : model.frames) {
    if (frame.parentJoint == 0) {
      frame.placement = X_BR * frame.placement;
    }
  }
}

}  // namespace

struct ArmChain::Impl {
  pinocchio::Model model;
  pinocchio::Data data;
  Eigen::VectorXd q;                                       // Pinocchio's configuration, shape (nq)
  std::array<pinocchio::JointIndex, kMaxJoints> joints{};  // by our index
  std::array<int, kMaxJoints> configuration{};             // first entry of q
  std::array<bool, kMaxJoints> continuous{};               // stored as (cos, sin)
  pinocchio::FrameIndex hand = 0;
  pinocchio::FrameIndex sensor = 0;

  explicit Impl(const pinocchio::Model& m) : model(m), data(model), q(pinocchio::neutral(model)) {}
};

ArmChain::ArmChain(const std::filesystem::path& urdf, const ArmChainNames& names) {
  try {
    pinocchio::Model model = arm_model(urdf, names.joints);
    const auto base = body_frame(model, names.base_frame, urdf);
    move_origin(model, pinocchio::SE3(model.frames[base].placement));
    impl_ = std::make_unique<Impl>(model);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw ModelError(urdf.string() + ": " + error.what());
  }
  for (std::size_t i = 0; i < names.joints.size(); ++i) {
    const auto joint = impl_->model.getJointId(names.joints[i]);
    if (joint >= static_cast<pinocchio::JointIndex>(impl_->model.njoints) || impl_->model.nvs[joint] != 1 ||
        impl_->model.idx_vs[joint] != static_cast<int>(i)) {
      throw ModelError(urdf.string() + ": joint " + names.joints[i] +
                       ": not a revolute, continuous or prismatic joint in this place");
    }
    impl_->joints[i] = joint;
    impl_->configuration[i] = impl_->model.idx_qs[joint];
    impl_->continuous[i] = impl_->model.nqs[joint] == 2;
  }
  impl_->hand = body_frame(impl_->model, names.hand_frame, urdf);
  impl_->sensor = body_frame(impl_->model, names.sensor_frame, urdf);
  J_B_.setZero(6, static_cast<Eigen::Index>(names.joints.size()));
  compute(JointVector::Zero(J_B_.cols()));
}

ArmChain::ArmChain(const ArmChain& other)
    : impl_(std::make_unique<Impl>(*other.impl_)), X_BE_(other.X_BE_), X_BF_(other.X_BF_), J_B_(other.J_B_) {}

ArmChain::~ArmChain() = default;

void ArmChain::compute(const JointVector& q) noexcept {
  Impl& m = *impl_;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (m.continuous[k]) {
      m.q[m.configuration[k]] = std::cos(q[i]);
      m.q[m.configuration[k] + 1] = std::sin(q[i]);
    } else {
      m.q[m.configuration[k]] = q[i];
    }
  }
  pinocchio::computeJointJacobians(m.model, m.data, m.q);
  const auto& hand = m.model.frames[m.hand];
  const auto& sensor = m.model.frames[m.sensor];
  X_BE_ = to_pose(m.data.oMi[hand.parentJoint] * hand.placement);
  X_BF_ = to_pose(m.data.oMi[sensor.parentJoint] * sensor.placement);
  J_B_ = m.data.J;  // (6, n)
}

Pose ArmChain::joint(int index) const noexcept {
  return to_pose(impl_->data.oMi[impl_->joints[static_cast<std::size_t>(index)]]);
}

}  // namespace ajar
