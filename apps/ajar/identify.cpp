#include "ajar/estimation/identify.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "identify_page.hpp"

namespace {

using ajar::Identification;
using ajar::MechanismType;
using ajar::Vector3d;

constexpr double kDegrees = 180.0 / std::numbers::pi;

std::string vector_text(const Vector3d& v) { return fmt::format("({:.4f}, {:.4f}, {:.4f})", v.x(), v.y(), v.z()); }

nlohmann::ordered_json vector_json(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

nlohmann::ordered_json to_json(const Identification& found) {
  nlohmann::ordered_json json;
  const bool curved = found.type != MechanismType::Slide && std::isfinite(found.radius);
  const nlohmann::ordered_json none;
  const auto if_curved = [&](const nlohmann::ordered_json& value) { return curved ? value : none; };
  json["type"] = type_name(found.type);
  json["type_confidence"] = found.type_confidence;
  json["axis"] = if_curved(vector_json(found.axis));
  json["axis_sigma"] = if_curved(found.axis_sigma);
  json["point"] = vector_json(curved ? found.point : found.start);
  json["point_sigma"] = curved ? found.point_sigma : found.start_sigma;
  json["radius_m"] = if_curved(found.radius);
  json["radius_m_sigma"] = if_curved(found.radius_sigma);
  json["radius_m_min"] = found.radius_min;
  json["direction"] = vector_json(found.direction);
  json["direction_sigma"] = found.direction_sigma;
  json["curvature_per_m"] = found.curvature.norm();
  json["curvature_per_m_sigma"] = found.curvature_sigma;
  json["curvature_per_m_noise_sigma"] = found.curvature_noise_sigma;
  json["against_slide"] = found.against_slide;
  json["against_hinge"] = found.against_hinge;
  json["against_one_curve"] = found.against_one_curve;
  json["samples"] = found.samples;
  json["outliers"] = found.outliers;
  json["length_m"] = found.length;
  json["rms_m"] = found.rms;
  json["rms_line_m"] = found.rms_line;
  json["uses_rotation"] = found.uses_rotation;
  json["noise_white_m"] = found.noise.position_white;
  json["noise_correlated_m"] = found.noise.position_correlated;
  json["noise_correlation_length_m"] = found.noise.correlation_length;
  return json;
}

void print_text(const Identification& found) {
  fmt::print("{}, confidence {:.4f}\n", type_name(found.type), found.type_confidence);
  if (found.type != MechanismType::Slide && std::isfinite(found.radius)) {
    fmt::print("  radius     {:.4f} ± {:.4f} m, more than {:.3f} m at 2 σ\n", found.radius, found.radius_sigma,
               found.radius_min);
    fmt::print("  axis       {} ± {:.2f}°\n", vector_text(found.axis), kDegrees * found.axis_sigma);
    fmt::print("  point      {} ± {:.4f} m, on the axis\n", vector_text(found.point), found.point_sigma);
  } else {
    fmt::print("  point      {} ± {:.4f} m, on the path\n", vector_text(found.start), found.start_sigma);
    fmt::print("  radius     more than {:.2f} m at 2 σ\n", found.radius_min);
  }
  fmt::print("  direction  {} ± {:.2f}°, at the start\n", vector_text(found.direction), kDegrees * found.direction_sigma);
  fmt::print("  curvature  {:.4f} ± {:.4f} 1/m, of which {:.4f} by measuring\n", found.curvature.norm(),
             found.curvature_sigma, found.curvature_noise_sigma);
  fmt::print(
      "  evidence   {:.1f} against a slide, {:.1f} against a hinge (a difference of {:.0f} decides), {:.1f} against one "
      "curve (at most 13.8)\n",
      found.against_slide, found.against_hinge, found.threshold, found.against_one_curve);
  fmt::print("  residuals  {:.2f} mm rms, {:.2f} mm from the best line, {} of {} samples left out as outliers\n",
             1e3 * found.rms, 1e3 * found.rms_line, found.outliers, found.samples);
  fmt::print("  path       {:.3f} m{}\n", found.length, found.uses_rotation ? ", the hand turns with it" : "");
  fmt::print("  noise      {:.2f} mm white, {:.2f} mm over {:.0f} mm of path\n", 1e3 * found.noise.position_white,
             1e3 * found.noise.position_correlated, 1e3 * found.noise.correlation_length);
}

struct Options {
  std::string track;
  std::string sensor = "auto";
  std::string out;
  bool json = false;
};

void run(const Options& options) {
  const std::map<std::string, ajar::SensorKind> kinds{{"auto", ajar::SensorKind::Auto},
                                                      {"robot", ajar::SensorKind::Robot},
                                                      {"mocap", ajar::SensorKind::MotionCapture},
                                                      {"vision", ajar::SensorKind::Vision}};
  const ajar::Track track = ajar::load_track(options.track);
  const Identification found = ajar::identify(track, {.sensor = kinds.at(options.sensor)}, options.track);
  if (!options.out.empty()) write_identify_page(options.out, options.track, track, found);
  if (options.json) {
    fmt::print("{}\n", to_json(found).dump(2));
  } else {
    print_text(found);
  }
}

}  // namespace

const char* type_name(MechanismType type) {
  switch (type) {
    case MechanismType::Hinge: return "hinge";
    case MechanismType::Slide: return "slide";
    case MechanismType::Unknown: break;
  }
  return "unknown";
}

void add_identify(CLI::App& program, int& exit_code) {
  CLI::App* const command = program.add_subcommand("identify", "Finds the mechanism behind a recorded track");
  const auto options = std::make_shared<Options>();
  command->add_option("TRACK", options->track, "Positions or poses of a handle, one sample a line")->required();
  command->add_option("--sensor", options->sensor, "What recorded it: auto (learns the noise), robot, mocap, vision")
      ->check(CLI::IsMember({"auto", "robot", "mocap", "vision"}));
  command->add_flag("--json", options->json, "Print JSON");
  command->add_option("--out", options->out, "Also draw track, path and residuals on this HTML page");
  command->callback([options, &exit_code] {
    run(*options);
    exit_code = kReached;
  });
}
