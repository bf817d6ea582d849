#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ajar/campaign/judge.hpp"
#include "ajar/campaign/run.hpp"

namespace ajar {

/// Whose controller runs a task of the thesis.
enum class Contestant {
  Thesis,     ///< Its laws with the printed errors mended, its settings and habits: open loop, inputs clipped one by one
  Corrected,  ///< The same laws with what they lack: pose feedback, common scaling, weights, adaptive damping, feed-forward
  Ours        ///< The default controller
};

/// One run of an experiment.
struct ExperimentPlan {
  std::string name;  ///< Of its run folder
  std::string file;  ///< Scenario file below scenarios/thesis
  Contestant contestant = Contestant::Thesis;
  std::vector<std::string> overrides;  ///< KEY=VALUE, after those of the contestant
  bool keep = false;                   ///< Writes a run folder
};

/// What one tick of a run showed, from the truth unless said otherwise.
struct ExperimentSample {
  double time = 0.0;                       ///< Since the start of the run [s]
  BasePose base;                           ///< [m, rad]
  double v = 0.0;                          ///< Commanded forward speed [m/s]
  double w = 0.0;                          ///< Commanded turning rate [rad/s]
  Vector3d hand = Vector3d::Zero();        ///< [m]
  double distance = 0.0;                   ///< Hand - base on the floor [m]
  double heading_error = 0.0;              ///< Base against the wanted motion of the hand, modulo a half turn [rad]
  double path_error = 0.0;                 ///< Of the hand from its path [m]
  double joint_rate = 0.0;                 ///< Largest commanded [rad/s]
  double joint_room = 0.0;                 ///< Smallest distance to a joint limit [rad]
  Vector3d direction = Vector3d::UnitX();  ///< True direction of the path at the hand
  Vector3d curvature = Vector3d::Zero();   ///< True curvature [1/m]
  Pose pose = Pose::Identity();            ///< Hand
};

/// A run: how the base came to its place, then how the hand moved.
struct ExperimentRun {
  ExperimentPlan plan;
  std::vector<ExperimentSample> approach;
  std::vector<ExperimentSample> following;
  RunResult result;
  double period = 0.002;  ///< [s]
};

/// A folder of the source or installed tree that holds the scenario files. @throws IoError
[[nodiscard]] std::filesystem::path thesis_scenarios();

/// The scenario of a plan, contestant and overrides applied. @throws ConfigError, IoError
[[nodiscard]] Scenario plan_scenario(const ExperimentPlan& plan);

/// Runs all plans on as many threads as stated; results in the order of the plans whatever the threads.
/// @param folder  Of the run folders; empty = none are written
/// @throws whatever a run throws
[[nodiscard]] std::vector<ExperimentRun> run_experiments(const std::vector<ExperimentPlan>& plans,
                                                         const PlantFactory& factory, const std::filesystem::path& folder,
                                                         int threads);

}  // namespace ajar
