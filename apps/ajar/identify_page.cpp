#include "identify_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <vector>

#include "ajar/core/error.hpp"
#include "ajar/core/markup.hpp"
#include "ajar/core/so3.hpp"

namespace {

using ajar::escape_markup;
using ajar::Identification;
using ajar::MechanismType;
using ajar::Track;
using ajar::Vector2d;
using ajar::Vector3d;

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kWidth = 560.0;   // of a picture [px]
constexpr double kMargin = 54.0;   // for the numbers beside it [px]
constexpr double kTicks = 5.0;     // about so many numbers along an axis
constexpr double kFrame = 0.05;    // free space round the drawing, of its size [-]
constexpr int kCurvePoints = 160;  // of the drawn path

constexpr const char* kStyle =
    R"(body{font:15px/1.45 system-ui,sans-serif;margin:2em auto;max-width:1180px;padding:0 1em;color:#1b2a38}
h1{font-size:1.35em;margin:0}h2{font-size:1em;margin:.4em 0}table{border-collapse:collapse;margin:1em 0}
td{padding:.15em 1.2em .15em 0;vertical-align:top}td:first-child{color:#5c6b78}.row{display:flex;flex-wrap:wrap;gap:24px}
svg{background:#fff}svg text{font:11px system-ui,sans-serif;fill:#5c6b78}.g{stroke:#e4e9ee}.s{fill:#2f7fb8}.o{stroke:#c0392b;stroke-width:1.5}
.p{fill:none;stroke:#e08a1e;stroke-width:2}.l{fill:none;stroke:#9aa7b2;stroke-width:1.2;stroke-dasharray:5 4}
.legend{color:#5c6b78;font-size:13px})";

// A rectangle of the plane, drawn with numbers along two sides.
class Picture {
 public:
  Picture(const Vector2d& low, const Vector2d& high, bool equal_scale, double height) : low_(low), height_(height) {
    const Vector2d size = (high - low).cwiseMax(1e-9);
    scale_ = Vector2d((kWidth - 2.0 * kMargin) / size.x(), (height - 2.0 * kMargin) / size.y());
    if (equal_scale) {
      const double least = scale_.minCoeff();
      low_ -= 0.5 * (Vector2d((kWidth - 2.0 * kMargin) / least, (height - 2.0 * kMargin) / least) - size);
      scale_.setConstant(least);
    }
    high_ = low_ + Vector2d((kWidth - 2.0 * kMargin) / scale_.x(), (height - 2.0 * kMargin) / scale_.y());
  }

  [[nodiscard]] Vector2d place(const Vector2d& p) const {
    return {kMargin + scale_.x() * (p.x() - low_.x()), height_ - kMargin - scale_.y() * (p.y() - low_.y())};
  }

  void grid(const char* x_name, const char* y_name) {
    for (const int axis : {0, 1}) {
      const double step = round_step((high_[axis] - low_[axis]) / kTicks);
      for (double v = std::ceil(low_[axis] / step) * step; v <= high_[axis]; v += step) {
        Vector2d from = low_, to = high_;
        from[axis] = to[axis] = v;
        const Vector2d a = place(from), b = place(to);
        body_ +=
            fmt::format("<line class='g' x1='{:.1f}' y1='{:.1f}' x2='{:.1f}' y2='{:.1f}'/>", a.x(), a.y(), b.x(), b.y());
        const double shown = std::abs(v) < 1e-9 * step ? 0.0 : v;
        body_ += axis == 0 ? fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='middle'>{:.4g}</text>", a.x(),
                                         a.y() + 15.0, shown)
                           : fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='end'>{:.4g}</text>", a.x() - 6.0,
                                         a.y() + 4.0, shown);
      }
    }
    body_ += fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='middle'>{}</text>", 0.5 * kWidth, height_ - 14.0, x_name);
    body_ += fmt::format("<text x='{:.1f}' y='{:.1f}'>{}</text>", kMargin, kMargin - 12.0, y_name);
  }

  void line(const std::vector<Vector2d>& points, const char* style) {
    body_ += fmt::format("<polyline class='{}' points='", style);
    for (const Vector2d& p : points) body_ += fmt::format("{:.1f},{:.1f} ", place(p).x(), place(p).y());
    body_ += "'/>";
  }
  void dot(const Vector2d& p, double size) {
    body_ += fmt::format("<circle class='s' cx='{:.1f}' cy='{:.1f}' r='{}'/>", place(p).x(), place(p).y(), size);
  }
  void cross(const Vector2d& p) {
    const Vector2d c = place(p);
    body_ += fmt::format("<path class='o' d='M{0:.1f},{1:.1f}l6,6m0,-6l-6,6'/>", c.x() - 3.0, c.y() - 3.0);
  }
  void label(const Vector2d& p, const char* text) {
    body_ += fmt::format("<text x='{:.1f}' y='{:.1f}'>{}</text>", place(p).x() + 8.0, place(p).y() - 6.0, text);
  }
  [[nodiscard]] std::string svg() const {
    return fmt::format("<svg width='{0:.0f}' height='{1:.0f}' viewBox='0 0 {0:.0f} {1:.0f}' role='img'>{2}</svg>", kWidth,
                       height_, body_);
  }

 private:
  static double round_step(double step) {
    const double ten = std::pow(10.0, std::floor(std::log10(step)));
    for (const double m : {1.0, 2.0, 5.0}) {
      if (step <= m * ten) return m * ten;
    }
    return 10.0 * ten;
  }

  Vector2d low_, high_{0.0, 0.0}, scale_{1.0, 1.0};
  double height_;
  std::string body_;
};

// Samples and path in the plane of the motion.
std::string draw_path(const Track& track, const Identification& found) {
  const Vector3d e1 = found.direction;
  const Vector3d e2 =
      found.axis.squaredNorm() > 0.5 ? Vector3d(found.axis.cross(e1).normalized()) : ajar::any_perpendicular(e1);
  const auto flat = [&](const Vector3d& p) { return Vector2d(e1.dot(p - found.start), e2.dot(p - found.start)); };
  const auto [first, last] = std::minmax_element(found.arc.begin(), found.arc.end());
  std::vector<Vector2d> path, line{flat(found.at(*first)), flat(found.at(*last))};
  for (int i = 0; i <= kCurvePoints; ++i) path.push_back(flat(found.at(*first + (*last - *first) * i / kCurvePoints)));
  Vector2d low = path.front(), high = path.front();
  const auto widen = [&](const Vector2d& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  };
  for (const Vector2d& p : path) widen(p);
  for (const ajar::TrackSample& sample : track.samples) widen(flat(sample.position));
  const bool hinge = found.type == MechanismType::Hinge;
  if (hinge) widen(flat(found.point));
  const Vector2d space = kFrame * (high - low);
  Picture picture(low - space, high + space, true, 460.0);
  picture.grid("along the first direction [m]", "across it, in the plane of motion [m]");
  picture.line(line, "l");
  for (std::size_t i = 0; i < track.samples.size(); ++i) {
    const Vector2d p = flat(track.samples[i].position);
    if (found.inlier[i]) {
      picture.dot(p, 2.0);
    } else {
      picture.cross(p);
    }
  }
  picture.line(path, "p");
  if (hinge) {
    picture.dot(flat(found.point), 5.0);
    picture.label(flat(found.point), "axis");
  }
  picture.label(flat(found.start), "start");
  return picture.svg();
}

std::string draw_distances(const Identification& found) {
  double most = 1e-4;
  for (std::size_t i = 0; i < found.arc.size(); ++i) {
    if (found.inlier[i]) most = std::max(most, found.distance[i]);
  }
  most *= 1.25;
  const auto [first, last] = std::minmax_element(found.arc.begin(), found.arc.end());
  Picture picture(Vector2d(*first, 0.0), Vector2d(*last, 1e3 * most), false, 460.0);
  picture.grid("arc from the first sample [m]", "distance from the path [mm]");
  for (std::size_t i = 0; i < found.arc.size(); ++i) {
    const Vector2d p(found.arc[i], 1e3 * std::min(found.distance[i], most));
    if (found.inlier[i]) {
      picture.dot(p, 2.0);
    } else {
      picture.cross(p);
    }
  }
  picture.line({Vector2d(*first, 1e3 * found.rms), Vector2d(*last, 1e3 * found.rms)}, "l");
  return picture.svg();
}

std::string table(const Identification& found) {
  std::string rows;
  const auto row = [&rows](const char* name, const std::string& value) {
    rows += fmt::format("<tr><td>{}</td><td>{}</td></tr>", name, value);
  };
  const auto text = [](const Vector3d& v) { return fmt::format("({:.3f}, {:.3f}, {:.3f})", v.x(), v.y(), v.z()); };
  const double kappa = found.curvature.norm();
  row("curvature", fmt::format("{:.3f} ± {:.3f} 1/m, of which {:.3f} by measuring", kappa, found.curvature_sigma,
                               found.curvature_noise_sigma));
  if (found.type == MechanismType::Hinge) {
    row("radius", fmt::format("{:.3f} ± {:.3f} m", found.radius, found.radius_sigma));
    row("axis", fmt::format("{} ± {:.1f}°, through {} ± {:.3f} m", text(found.axis), kDegrees * found.axis_sigma,
                            text(found.point), found.point_sigma));
  } else {
    row("radius", fmt::format("more than {:.2f} m at 2 σ", found.radius_min));
  }
  row("direction at the start", fmt::format("{} ± {:.1f}°", text(found.direction), kDegrees * found.direction_sigma));
  row("evidence", fmt::format("{:.1f} against a slide, {:.1f} against a hinge; a difference of {:.0f} decides",
                              found.against_slide, found.against_hinge, found.threshold));
  row("halves", fmt::format("{:.2f} and {:.2f} 1/m, {:.1f} against one curve (at most 13.8)", found.half_curvature[0],
                            found.half_curvature[1], found.against_one_curve));
  row("samples", fmt::format("{}, {} left out as outliers; {:.2f} mm rms, {:.2f} mm from the best line", found.samples,
                             found.outliers, 1e3 * found.rms, 1e3 * found.rms_line));
  return "<table>" + rows + "</table>";
}

}  // namespace

void write_identify_page(const std::string& file, const std::string& title, const Track& track,
                         const Identification& found) {
  std::ofstream out(file);
  out << "<!doctype html><html lang='en'><meta charset='utf-8'><meta name='viewport' content='width=device-width'><title>"
      << escape_markup(title) << "</title><style>" << kStyle << "</style><h1>" << type_name(found.type)
      << fmt::format(", confidence {:.4f}", found.type_confidence) << "</h1><div class='legend'>" << escape_markup(title)
      << "</div>" << table(found) << "<div class='row'><div><h2>Track and path</h2>" << draw_path(track, found)
      << "<div class='legend'>dots: samples, crosses: outliers, orange: the path found, dashed: its "
         "chord</div></div><div><h2>Distance "
         "from the path</h2>"
      << draw_distances(found)
      << "<div class='legend'>dashed: root mean square of the inliers; outliers beyond the frame at its "
         "top</div></div></div></html>\n";
  out.flush();
  if (!out) throw ajar::IoError(file + ": cannot be written");
}
