// The input of `kerf drive`: materials, paths of deformation for one element, what they are compared with and drawn
// against.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/diagnostics.hpp"
#include "input/document.hpp"
#include "input/library.hpp"
#include "input/model_input.hpp"
#include "plugin/registry.hpp"

namespace kerf {

/// A table that a path is compared with.
struct ReferenceInput {
  std::string file, time, label;
  std::map<std::string, std::string> columns;  // heading in the file by the name of a column of the driver
  double tolerance = -1.0;  // of all columns that have none of their own; negative where absent
  std::map<std::string, std::string> tolerances, rms;  // by column
  std::vector<std::int64_t> skip, loose;  // rows, counted from 0 after the heading
  double loose_tolerance = 0.0;
  static void describe(Schema<ReferenceInput>& s);
};

/// A path of deformation, from the undeformed element on.
struct PathInput {
  std::string name, type, file, after_failure;
  std::vector<std::string> materials;  // empty for all
  std::vector<double> strains, lateral_strains, times;  // [-], [-], [s]
  std::vector<double> strain_rates, lateral_strain_rates;  // [1/s]
  double rate = 0.0;  // [1/s]
  double lateral_stress = 0.0, confinement = 0.0;  // [Pa]
  double isotropic_until = 0.0;  // [s]
  std::int64_t steps = 0, rows = 0;
  std::map<std::string, std::string> initial_state;
  std::vector<std::unique_ptr<ReferenceInput>> references;
  static void describe(Schema<PathInput>& s);

  /// Whether the lateral stress is given, and the lateral strain follows.
  bool keeps_lateral_stress() const { return type == "uniaxial_stress" || type == "triaxial"; }
};

/// Points that are drawn into a picture, of an experiment for example.
struct PointsInput {
  std::string file, label;
  std::vector<std::string> columns;
  double x_scale = 1.0, y_scale = 1.0;
  static void describe(Schema<PointsInput>& s);
};

/// One picture: a column against another, of all materials and paths.
struct PictureInput {
  std::string name, x, y;
  std::vector<std::string> paths;  // empty for all
  std::vector<std::unique_ptr<PointsInput>> points;
  static void describe(Schema<PictureInput>& s);
};

/// What a drive file holds. The blocks that an input file has as well have the same form.
struct DriveInput : ModelInput {
  double size = 0.0;  // edge of the element [m]
  std::unique_ptr<Element> element;
  std::vector<std::unique_ptr<PathInput>> paths;
  std::vector<std::unique_ptr<PictureInput>> pictures;
  std::map<const PathInput*, std::string> origins;  // where a path is written
  static void describe(Schema<DriveInput>& s);
};

/// What stands at the top of a drive file.
const Description& drive_description();

/// Reads a drive file after the overrides "key.path=value". Throws InputError with all mistakes, those of the laws
/// included. Files that it names are read by read_text_file, relative to the drive file.
std::unique_ptr<DriveInput> read_drive_input(const std::string& file_name, const std::string& bytes,
                                             const std::vector<std::string>& overrides, const Registry& registry,
                                             const std::vector<std::string>& library = library_folders());

}  // namespace kerf
