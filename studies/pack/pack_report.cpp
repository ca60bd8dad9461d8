#include "studies/pack/pack_report.h"

#include <algorithm>
#include <cmath>
#include <system_error>

#include <fmt/format.h>

#include "report/page.h"
#include "report/svg_plot.h"
#include "report/svg_text.h"
#include "simulation/packing/point_spectrum.h"
#include "studies/pack/packing_picture.h"

namespace osteon::studies {
namespace {

using simulation::Bone;
using simulation::MassProperties;

/// A bar with the colours of the radii, on a logarithmic scale.
std::string RadiusLegend(double min_mm, double max_mm) {
  std::string stops;
  for (int i = 0; i <= 8; ++i) {
    const Vector3 c = 255.0 * Viridis(i / 8.0);
    stops += fmt::format("<stop offset=\"{}\" stop-color=\"rgb({:.0f},{:.0f},{:.0f})\"/>", i / 8.0, c.x(),
                         c.y(), c.z());
  }
  std::string out = fmt::format(
      "<svg width=\"420\" height=\"44\" viewBox=\"0 0 420 44\" "
      "style=\"max-width:100%;height:auto\" xmlns=\"http://www.w3.org/2000/svg\" "
      "font-family=\"{}\" font-size=\"12\" fill=\"{}\"><defs><linearGradient "
      "id=\"radii\">{}</linearGradient></defs>"
      "<rect x=\"60\" y=\"4\" width=\"300\" height=\"14\" fill=\"url(#radii)\"/>",
      report::Escape(report::kFontFamily), report::kTextColor, stops);
  for (int i = 0; i <= 2; ++i)
    out += fmt::format("<text x=\"{}\" y=\"34\" text-anchor=\"middle\">{} mm</text>", 60 + 150 * i,
                       report::Number(min_mm * std::pow(max_mm / min_mm, i / 2.0)));
  return out + "<text x=\"0\" y=\"15\">radius</text></svg>\n";
}

/// Pictures of all spheres and of the half behind the middle plane, with the legends of radii and materials.
tl::expected<std::string, std::string> Pictures(const PackReportInput& input) {
  const Bone& bone = input.bone;
  const CutAway plane = MiddlePlane(bone);
  const double least = std::log(input.quality.r_min_m), range = std::log(input.quality.r_max_m) - least;
  const auto by_radius = [&](std::size_t i, const Vector3&) {
    return Viridis(range > 0.0 ? (std::log(bone.balls[i].radius_m) - least) / range : 0.5);
  };
  const auto by_material = [&](std::size_t, const Vector3& p_G) {
    return report::MaterialColor(bone, input.solid.MaterialAt(p_G));
  };
  const report::Camera camera = PackingCamera(bone, plane, 470, 470);
  const auto outside = report::Picture(
      RenderPacking(bone.balls, camera, std::nullopt, by_radius, input.threads), "All spheres, by radius.");
  if (!outside) return outside;
  const auto half =
      report::Picture(RenderPacking(bone.balls, camera, plane, by_radius, input.threads),
                      "The half behind the middle plane: spheres that it cuts show their inside.");
  if (!half) return half;
  const auto inside = report::Picture(
      RenderPacking(bone.balls, PackingCamera(bone, plane, 760, 560), plane, by_material, input.threads),
      "The same half by material, as the solid has it there; gaps show what lies behind them.");
  if (!inside) return inside;
  std::string tints;
  for (const simulation::Material& material : bone.materials) {
    const auto index = static_cast<simulation::MaterialIndex>(&material - bone.materials.data());
    tints += fmt::format(
        "<span style=\"display:inline-block;width:12px;height:12px;border:1px solid #8a939c;"
        "background:{};margin:0 6px 0 16px\"></span>{}",
        report::MaterialTint(bone, index), report::Escape(material.name));
  }
  return "<h2>Spheres</h2>\n<div class=\"pair\">\n" + *outside + *half + "</div>\n" +
         RadiusLegend(input.quality.r_min_m * 1e3, input.quality.r_max_m * 1e3) + *inside +
         "<p class=\"sub\">" + tints + "</p>\n";
}

/// The outline of the spheres' union in the middle plane, on a picture of the solid's materials.
std::string SectionFigure(const PackReportInput& input) {
  // ComputeSection draws the surroundings of the cut site: set a site in the bone's middle that is as wide as
  // the bone.
  Bone bone = input.bone;
  const CutAway plane = MiddlePlane(bone);
  const Eigen::AlignedBox3d box = input.solid.Bounds();
  const Vector3 middle = box.center() - (box.center() - plane.point).dot(plane.normal) * plane.normal;
  Vector3 axis = input.bone.site.radius_m > 0.0 ? Vector3(input.bone.site.axis) : Vector3::UnitZ();
  axis -= axis.dot(plane.normal) * plane.normal;
  if (axis.norm() < 0.1) axis = plane.normal.unitOrthogonal();
  bone.site = {.center_m = middle, .axis = axis.normalized(), .radius_m = 0.5 * box.diagonal().norm()};
  const report::Section section = report::ComputeSection(bone, {}, {}, {},
                                                         {.step_m = box.diagonal().norm() / 900.0,
                                                          .reach_in_cup_radii = 1.0,
                                                          .depth_in_cup_radii = 1.0,
                                                          .solid = &input.solid});
  return "<h2>Section</h2>\n" + report::Figure(report::SectionSvg(section, bone),
                                               "Union of the spheres in a plane through the middle.");
}

/// Histogram of the radii, and the distribution of the gaps from the solid's surface to the spheres.
std::string Histograms(const PackReportInput& input) {
  std::vector<double> radii_mm;
  radii_mm.reserve(input.bone.balls.size());
  for (const simulation::Ball& ball : input.bone.balls) radii_mm.push_back(ball.radius_m * 1e3);
  report::Histogram radii{.title = "Radii of the spheres",
                          .x_label = "radius [mm]",
                          .values = std::move(radii_mm),
                          .log_x = true,
                          .log_y = true,
                          .unit = "mm",
                          .percentiles = false};

  report::Series share{.name = "share of the surface with a lesser gap", .color = "#0072b2", .width_px = 1.8};
  for (std::size_t i = 0; i <= 100; ++i) {
    share.x.push_back(input.quality.surface_gap_percentiles_m[i] * 1e3);
    share.y.push_back(static_cast<double>(i));
  }
  const report::LineChart gaps{.title = "Gap between the surface and the spheres",
                               .x_label = "gap [mm]",
                               .y_label = "share of the surface [%]",
                               .series = {std::move(share)},
                               .limits = {{95.0, "95 %"}},
                               .plot_height_px = 200.0};
  return "<h2>Radii and gaps</h2>\n<div class=\"pair\">\n" +
         report::Figure(report::Svg(radii), "Counts on a logarithmic axis.") +
         report::Figure(report::Svg(gaps, 450.0),
                        fmt::format("{} places of the surface; 0 where a sphere holds the place.",
                                    input.quality.surface_samples)) +
         "</div>\n";
}

/// Plot that shows whether the mass points are distributed as blue noise.
std::string Spectrum(const PackReportInput& input) {
  const auto& points = input.bone.points;
  if (points.empty()) return {};
  std::vector<Vector3> places;
  for (const simulation::MassPoint& point : points) places.emplace_back(point.p_m);
  const auto windows = simulation::UniformWindows(input.solid, input.zone, input.point_params);
  const auto spectrum = simulation::ComputeRadialSpectrum(places, windows, {.threads = input.threads});
  std::string out = "<h2>Mass points</h2>\n";
  if (spectrum.power.empty())
    return out + "<p>No spectrum: nowhere in the solid is there room for a cube of five spacings.</p>\n";
  const report::LineChart chart{.x_label = "waves per mean spacing",
                                .y_label = "power",
                                .series = {{.name = "mass points",
                                            .x = spectrum.frequency_per_mean_spacing,
                                            .y = spectrum.power,
                                            .width_px = 1.8},
                                           {.name = "independent points",
                                            .x = {spectrum.frequency_per_mean_spacing.front(),
                                                  spectrum.frequency_per_mean_spacing.back()},
                                            .y = {1.0, 1.0},
                                            .color = report::kMutedColor}},
                                .plot_height_px = 200.0};
  return out +
         report::Figure(
             report::Svg(chart),
             fmt::format("Radially averaged power spectrum of {} points, over {} cubes in which they are "
                         "evenly dense. Blue noise has next to nothing at low frequencies: sums over a "
                         "region that is cut are then as even as the points are.",
                         points.size(), windows.size()));
}

/// Table of mass and inertia of the mass points, compared with the solid's if both are known.
std::string Mass(const PackReportInput& input) {
  if (input.bone.points.empty()) return {};
  std::string out = "<h2>Mass</h2>\n<table>\n<tr><th></th><th class=\"n\">points, their materials</th>";
  std::vector<MassProperties> columns{input.mass};
  if (input.even_points) {
    out += "<th class=\"n\">points, all of 1 g/cm³</th>";
    columns.push_back(*input.even_points);
  }
  if (input.even_solid) {
    out += "<th class=\"n\">the solid itself, of 1 g/cm³</th>";
    columns.push_back(*input.even_solid);
  }
  out += "</tr>\n";
  const auto row = [&](const char* name, const auto& text) {
    out += fmt::format("<tr><td>{}</td>", name);
    for (const MassProperties& m : columns) out += "<td class=\"n\">" + text(m) + "</td>";
    out += "</tr>\n";
  };
  row("volume [mm³]", [](const MassProperties& m) { return fmt::format("{:.2f}", m.volume_m3 * 1e9); });
  row("mass [g]", [](const MassProperties& m) { return fmt::format("{:.4f}", m.mass_kg * 1e3); });
  row("centre of mass [mm]", [](const MassProperties& m) {
    const Vector3 c = m.center_of_mass_m * 1e3;
    return fmt::format("{:.3f}, {:.3f}, {:.3f}", c.x(), c.y(), c.z());
  });
  row("Ixx, Iyy, Izz [g cm²]", [](const MassProperties& m) {
    const Matrix3 i = m.inertia_kg_m2 * 1e7;
    return fmt::format("{:.5g}, {:.5g}, {:.5g}", i(0, 0), i(1, 1), i(2, 2));
  });
  row("Ixy, Ixz, Iyz [g cm²]", [](const MassProperties& m) {
    const Matrix3 i = m.inertia_kg_m2 * 1e7;
    return fmt::format("{:.5g}, {:.5g}, {:.5g}", i(0, 1), i(0, 2), i(1, 2));
  });
  out += "</table>\n<p class=\"sub\">Inertia about the centre of mass, along the axes of the bone's frame.";
  if (input.even_solid) out += " The solid's own figures are exact (closed form).";
  return out + "</p>\n";
}

/// Table of the materials' figures with their sources.
std::string Materials(const PackReportInput& input) {
  std::string out =
      "<h2>Materials</h2>\n<table>\n<tr><th>material</th><th>figure</th><th "
      "class=\"n\">value</th><th>source</th></tr>\n";
  for (const simulation::Material& m : input.bone.materials) {
    const auto row = [&](const char* figure, const std::string& value,
                         const simulation::FigureSource& source) {
      out += fmt::format(
          "<tr><td>{}</td><td>{}</td><td class=\"n\">{}</td><td>{}{}</td></tr>\n", report::Escape(m.name),
          figure, report::Escape(value), source.assumed ? "<b>assumed</b>" : "",
          source.text.empty() ? "" : report::Escape((source.assumed ? ": " : "") + source.text));
    };
    row("density", fmt::format("{:g} g/cm³", m.density_kg_per_m3 * 1e-3), m.density_source);
    row("cutting energy", fmt::format("{:g} J/mm³", m.specific_cutting_energy_J_per_m3 * 1e-9),
        m.cutting_energy_source);
    row("cutting-force ratio", fmt::format("{:g}", m.cutting_force_ratio), m.cutting_force_source);
    row("friction", fmt::format("{:g}", m.friction), m.friction_source);
    if (m.edge_force_N_per_m > 0.0)
      row("edge force",
          fmt::format("{:g} N/mm, energy at a chip of {:g} µm", 1e-3 * m.edge_force_N_per_m,
                      1e6 * m.measured_chip_m),
          m.edge_force_source);
  }
  return out + "</table>\n";
}

/// Table of the packing's source and parameters, with the times and the command.
std::string Origin(const PackReportInput& input) {
  std::string out = "<h2>How it was made</h2>\n<table>\n";
  const auto row = [&out](const std::string& key, const std::string& value) {
    out += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", report::Escape(key), report::Escape(value));
  };
  row("source", input.provenance.source);
  if (input.provenance.source_crc) row("its CRC-32", fmt::format("{:08x}", *input.provenance.source_crc));
  for (const auto& [key, value] : input.provenance.parameters) row(key, value);
  for (const report::SummaryRow& time : input.times) row(time.key, time.value);
  out += "</table>\n";
  if (!input.command_line.empty()) out += "<pre>" + report::Escape(input.command_line) + "</pre>\n";
  return out;
}

}  // namespace

tl::expected<std::string, std::string> MakePackReport(const PackReportInput& input) {
  const auto pictures = Pictures(input);
  if (!pictures) return tl::unexpected(pictures.error());
  std::string html = report::PageBegin(
      {.title = "Packing: " + input.bone.name,
       .subtitle = "From " + input.provenance.source,
       .verdict = report::ReportVerdict{.level = input.good ? "good" : "bad", .text = input.verdict},
       .summary = input.summary});
  html += *pictures + SectionFigure(input) + Histograms(input) + Spectrum(input) + Mass(input) +
          Materials(input) + Origin(input);
  if (!input.version.empty()) html += "<footer>Osteon " + report::Escape(input.version) + "</footer>\n";
  return html + report::PageEnd();
}

tl::expected<void, std::string> WritePackReport(const PackReportInput& input,
                                                const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::create_directories(path.parent_path(), error);
  if (error) return tl::unexpected(path.parent_path().string() + ": " + error.message());
  const auto html = MakePackReport(input);
  if (!html) return tl::unexpected(path.string() + ": " + html.error());
  return report::WritePage(*html, path);
}

}  // namespace osteon::studies
