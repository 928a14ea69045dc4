// Steps of all paths, tables of checks, and files of curves.
#include "drive/drive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/activity.hpp"
#include "core/flush_denormals.hpp"
#include "core/physics_error.hpp"
#include "drive/reference.hpp"
#include "input/curve_table.hpp"

namespace kerf {

namespace {

bool takes(const PathInput& path, const MaterialInput& material) {
  return path.materials.empty() ||
         std::find(path.materials.begin(), path.materials.end(), material.name) != path.materials.end();
}

std::string text_of(const std::string& folder, const std::string& file, const std::string& where) {
  std::string failure;
  const std::string text = read_text_file((std::filesystem::path(folder) / file).string(), failure);
  if (!failure.empty())
    throw InputError({fmt::format("{}: error: the file {} cannot be read: {}", where, file, failure)});
  return text;
}

/// Moments that a step has to end at: those of the motion, and of the references [s], from the motion's begin.
std::vector<double> stops_of(const Motion& motion, const std::vector<Reference>& references) {
  std::vector<double> all = motion.moments();
  for (const Reference& r : references) all.insert(all.end(), r.times().begin(), r.times().end());
  std::sort(all.begin(), all.end());
  std::vector<double> apart;
  for (const double t : all)
    if (apart.empty() || t > apart.back() + 1e-12 * motion.end()) apart.push_back(t);
  return apart;
}

class Driver {
 public:
  Driver(const DriveInput& input, const std::string& folder, double refine)
      : input_(input), folder_(folder), refine_(refine) {}

  DrivenCurve along(const MaterialInput& material, const PathInput& path) {
    const std::string where = input_.origins.at(&path);
    Motion motion(path, path.file.empty() ? "" : text_of(folder_, path.file, where),
                  (std::filesystem::path(folder_) / path.file).string());
    DrivenCurve curve;
    curve.material = material.name;
    curve.path = path.name;
    std::unique_ptr<DrivenCell> cell;
    try {
      cell = std::make_unique<DrivenCell>(input_, material, *input_.element, path, motion);
    } catch (const std::exception& e) {
      throw InputError(
          {fmt::format("{}: error: path {} of material {}: {}", where, path.name, material.name, e.what())});
    }
    curve.columns = cell->columns();
    std::vector<Reference> references;
    for (const auto& r : path.references) references.emplace_back(*r, folder_, where, curve.columns, motion.end());
    try {
      go(path, motion, *cell, references, curve);
    } catch (const LawError& e) {
      throw PhysicsError(fmt::format("material {} on path {} at {:.6g} s: the law `{}` ({}) cannot go on: {}",
                                     material.name, path.name, cell->time(), e.law->type, e.law->origin, e.what()));
    } catch (const std::exception& e) {
      throw PhysicsError(
          fmt::format("material {} on path {} at {:.6g} s: {}", material.name, path.name, cell->time(), e.what()));
    }
    for (const Reference& r : references)
      for (DriveCheck& check : r.checks()) curve.checks.push_back(std::move(check));
    return curve;
  }

 private:
  void go(const PathInput& path, const Motion& motion, DrivenCell& cell, std::vector<Reference>& references,
          DrivenCurve& curve) {
    curve.rows.push_back(cell.row());
    cell.confine();
    if (cell.time() > 0.0) curve.rows.push_back(cell.row());
    for (Reference& r : references) r.see(0.0, cell.row());
    const std::vector<double> stops = stops_of(motion, references);
    const double most = motion.end() / (static_cast<double>(path.steps) * refine_);
    const double between_rows = motion.end() / static_cast<double>(path.rows);
    double next_row = between_rows;
    for (std::size_t s = 1; s < stops.size(); ++s) {
      const double length = stops[s] - stops[s - 1];
      const auto n = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(length / most - 1e-6)));
      for (std::int64_t i = 1; i <= n; ++i) {
        activity::beat();
        const double t = i == n ? stops[s] : stops[s - 1] + length * static_cast<double>(i) / static_cast<double>(n);
        cell.advance(motion.begin() + t);
        ++curve.steps;
        const bool fails = cell.has_failed() && curve.failed_at < 0.0;
        if (fails) curve.failed_at = cell.time();
        if (i == n)
          for (Reference& r : references) r.see(t, cell.row());
        if (t >= next_row * (1.0 - 1e-12) || i == n || fails) curve.rows.push_back(cell.row());
        while (next_row <= t * (1.0 + 1e-12)) next_row += between_rows;
        if (fails && path.after_failure == "stop") return;
      }
    }
  }

  const DriveInput& input_;
  const std::string& folder_;
  double refine_;
};

std::string file_of(const DrivenCurve& curve) { return curve.material + "." + curve.path + ".csv"; }

void write_csv(const DrivenCurve& curve, const std::string& path) {
  std::string text;
  for (std::size_t c = 0; c < curve.columns.size(); ++c) text += (c > 0 ? "," : "") + curve.columns[c].name;
  text += "\n";
  for (const std::vector<double>& row : curve.rows) {
    for (std::size_t c = 0; c < row.size(); ++c) text += fmt::format("{}{:.12g}", c > 0 ? "," : "", row[c]);
    text += "\n";
  }
  std::ofstream out(path, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw std::runtime_error(fmt::format("cannot write {}", path));
}

nlohmann::json picture_json(const PictureInput& picture, const std::string& input_folder) {
  nlohmann::json points = nlohmann::json::array();
  for (const auto& p : picture.points)
    points.push_back({{"file", (std::filesystem::path(input_folder) / p->file).string()},
                      {"columns", p->columns},
                      {"scales", {p->x_scale, p->y_scale}},
                      {"label", p->label.empty() ? std::filesystem::path(p->file).stem().string() : p->label}});
  return {{"name", picture.name.empty() ? picture.y + "_over_" + picture.x : picture.name},
          {"x", picture.x},
          {"y", picture.y},
          {"paths", picture.paths},
          {"points", points}};
}

nlohmann::json references_json(const PathInput& path, const std::string& input_folder) {
  nlohmann::json all = nlohmann::json::array();
  for (const auto& r : path.references)
    all.push_back({{"file", (std::filesystem::path(input_folder) / r->file).string()},
                   {"label", r->label.empty() ? std::filesystem::path(r->file).stem().string() : r->label},
                   {"time", r->time},
                   {"columns", r->columns}});
  return all;
}

}  // namespace

std::vector<DrivenCurve> drive(const DriveInput& input, const std::string& folder, double refine) {
  const FlushDenormals flush;
  std::vector<DrivenCurve> curves;
  Driver driver(input, folder, refine);
  for (const auto& path : input.paths)
    for (const auto& material : input.materials)
      if (takes(*path, *material)) curves.push_back(driver.along(*material, *path));
  return curves;
}

std::string check_table(const std::vector<DrivenCurve>& curves) {
  std::string text;
  for (const DrivenCurve& curve : curves)
    for (const DriveCheck& c : curve.checks) {
      if (text.empty())
        text = fmt::format("{:<24} {:<28} {:<34} {:>9} {:>9} {:>7}\n", "material", "path", "column", "error", "allowed",
                           "at row");
      text += fmt::format("{:<24} {:<28} {:<34} {:>9.2e} {:>9.2e} {:>7} {}\n", curve.material, curve.path, c.column,
                          c.error, c.tolerance, c.row, c.passes() ? "pass" : "FAIL");
    }
  return text;
}

void write_curves(const DriveInput& input, const std::string& input_folder, const std::vector<DrivenCurve>& curves,
                  const std::string& folder) {
  std::filesystem::create_directories(folder);
  nlohmann::json all = {
      {"title", input.title}, {"curves", nlohmann::json::array()}, {"pictures", nlohmann::json::array()}};
  for (const DrivenCurve& curve : curves) {
    write_csv(curve, folder + file_of(curve));
    const auto& path =
        *std::find_if(input.paths.begin(), input.paths.end(), [&](const auto& p) { return p->name == curve.path; });
    nlohmann::json units;
    for (const DrivenColumn& c : curve.columns) units[c.name] = c.unit;
    nlohmann::json entry = {{"material", curve.material}, {"path", curve.path},
                            {"file", file_of(curve)},     {"units", units},
                            {"steps", curve.steps},       {"references", references_json(*path, input_folder)}};
    entry["failed_at"] = curve.failed_at < 0.0 ? nlohmann::json() : nlohmann::json(curve.failed_at);
    for (const DriveCheck& c : curve.checks)
      entry["checks"].push_back({{"column", c.column},
                                 {"file", c.file},
                                 {"error", std::isfinite(c.error) ? nlohmann::json(c.error) : nlohmann::json()},
                                 {"allowed", c.tolerance},
                                 {"row", c.row},
                                 {"passes", c.passes()}});
    all["curves"].push_back(std::move(entry));
  }
  for (const auto& picture : input.pictures) all["pictures"].push_back(picture_json(*picture, input_folder));
  std::ofstream out(folder + "drive.json", std::ios::binary);
  out << all.dump(1) << "\n";
  out.close();
  if (!out) throw std::runtime_error(fmt::format("cannot write {}drive.json", folder));
}

}  // namespace kerf
