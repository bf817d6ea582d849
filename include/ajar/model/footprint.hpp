#pragma once

#include "ajar/model/robot_model.hpp"

namespace ajar {

/// Rectangle on the floor that holds all that the base carries, its sides along the base's own axes; origin on the axle.
struct Footprint {
  double front = 0.0;       ///< Ahead of the axle [m]
  double rear = 0.0;        ///< Behind the axle [m]
  double half_width = 0.0;  ///< To each side [m]
};

/// Footprint of the collision shapes that the arm does not move; zero without any. [m]
[[nodiscard]] Footprint base_footprint(const RobotModel& model);

}  // namespace ajar
