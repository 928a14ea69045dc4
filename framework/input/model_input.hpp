// The input file as the program sees it: every block, key, unit and default, declared once.
//
// From these declarations come parsing, messages, `kerf schema` and the reference manual.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "input/work_model.hpp"
#include "kerf/balance_policy.hpp"
#include "kerf/boundary.hpp"
#include "kerf/contact.hpp"
#include "kerf/curve.hpp"
#include "kerf/element.hpp"
#include "kerf/eos.hpp"
#include "kerf/erosion.hpp"
#include "kerf/load.hpp"
#include "kerf/material.hpp"
#include "kerf/mesh.hpp"
#include "kerf/observer.hpp"
#include "kerf/partitioner.hpp"
#include "kerf/schema.hpp"
#include "kerf/solid.hpp"

namespace kerf {

class Measure;

struct TimeInput {
  double end = 0.0, safety_factor = 0.9, initial_step = 0.0, minimum_step = 0.0, maximum_step = 0.0, growth = 1.1;
  std::int64_t maximum_cycles = 0;
  static void describe(Schema<TimeInput>& s);
};

/// A named function of time: a table, or two columns of a file.
struct CurveInput {
  std::string name, file;
  std::vector<double> times, values;  // [s], [-]
  std::vector<std::string> columns;
  double period = 0.0, time_scale = 1.0, value_scale = 1.0;
  Curve curve;  // made of the above by a CurveTable
  bool has_points() const { return !times.empty() && times.size() == values.size(); }
  bool ascends() const;
  bool fits_period() const;
  static void describe(Schema<CurveInput>& s);
};

struct ErosionInput {
  std::string rule;
  std::int64_t count = 0, fade_out = 0;  // the former 0 where absent
  std::vector<std::unique_ptr<ErosionCriterion>> criteria;
  static void describe(Schema<ErosionInput>& s);
};

struct MaterialInput {
  std::string name;
  std::string library;  // name of a set; its blocks are in their places already, without this key
  double density = 0.0;
  std::unique_ptr<Material> strength;  // this and an EOS, or a solid
  std::unique_ptr<Eos> eos;
  std::unique_ptr<Solid> solid;
  std::unique_ptr<ErosionInput> erosion;
  static void describe(Schema<MaterialInput>& s);

  /// The law of the deviator or of the whole stress. Pre: the input is valid.
  const Law& stress_law() const { return solid ? static_cast<const Law&>(*solid) : *strength; }
  /// All laws that there are, in the order in which they act in a step.
  std::vector<const Law*> laws() const;
};

/// Values of a state variable, or of the specific internal energy, before the first step.
struct InitialStateInput {
  std::vector<std::string> elements;  // parts, or sets that hold all nodes of an element; empty for all
  std::string variable, value;
  std::string origin;  // where it was written; not a key of the input
  static void describe(Schema<InitialStateInput>& s);
};

/// One step of placing a part: a rotation about an axis through a point, then a translation.
struct PlacementInput {
  double angle = 0.0;
  Vec3 axis{0.0, 0.0, 1.0}, about, translate;
  static void describe(Schema<PlacementInput>& s);
};

struct PartInput {
  std::string name, material;
  std::unique_ptr<MeshGenerator> mesh;
  std::unique_ptr<Element> element;
  std::vector<std::unique_ptr<PlacementInput>> placement;
  Vec3 velocity;
  static void describe(Schema<PartInput>& s);
};

/// A named set of nodes; facets and elements belong to it when all their nodes do.
struct SetInput {
  std::string name, face;
  std::vector<std::string> parts;
  std::vector<double> box;  // x_min, y_min, z_min, x_max, y_max, z_max; empty where absent
  bool has_proper_box() const;  // or none
  static void describe(Schema<SetInput>& s);
};

/// Parts that become one where nodes of their undeformed meshes meet.
struct JoinedInput {
  std::vector<std::string> parts;
  double tolerance = 0.0;  // [m]; 0 where absent
  std::string origin;  // where it was written; not a key of the input
  static void describe(Schema<JoinedInput>& s);
};

struct BalanceInput {
  bool enabled = true;
  std::int64_t force_interval = 0;
  std::unique_ptr<Partitioner> partitioner, contact_partitioner;
  std::unique_ptr<BalancePolicy> policy;
  std::string work_model;  // file; empty where absent
  std::string contact_work;  // own, with_elements
  std::string foresee;  // folder of an earlier run, from the present folder; empty where absent
  std::string foresee_origin;  // where it was written; not a key of the input
  WorkModel work;  // read from the file; not a key of the input
  bool has_contact_with_elements() const { return contact_work == "with_elements"; }
  static void describe(Schema<BalanceInput>& s);
};

struct OutputInput {
  double results_interval = 0.0, history_interval = 0.0, restart_interval = 0.0, recording_interval = 0.0;
  bool restart_at_end = true;
  std::int64_t progress_interval = 0;
  std::string precision;
  std::vector<std::string> element_fields, node_fields;
  static void describe(Schema<OutputInput>& s);
};

struct ChecksInput {
  double energy_growth = 0.05, maximum_speed = 0.0, let_go = 0.01, stall_limit = 600.0;
  std::string free_nodes;
  double drop_distance = 0.0;
  static void describe(Schema<ChecksInput>& s);
};

/// How the input has named a set of the material library.
struct LibraryUse {
  std::string material, set, file, hash;
  bool verified = false;
  std::vector<std::string> overridden;  // paths inside the material
};

/// Where the input was a keyword deck: what became of it.
struct DeckNote {
  std::string units;  // "g, cm, us"; empty for other inputs
  std::int64_t in_another_way = 0, left_out = 0;  // messages of these kinds
  std::map<std::string, std::vector<std::string>> keywords;  // by what became of them
};

struct ModelInput {
  std::string title, precision;
  std::vector<std::string> plugins;  // shared libraries; they are loaded already
  std::vector<std::string> library;  // folders of further sets; they are in their places already
  std::map<std::string, std::string> parameters;  // as written; they are in their places already
  TimeInput time;
  std::vector<std::unique_ptr<CurveInput>> curves;
  std::vector<std::unique_ptr<MaterialInput>> materials;
  std::vector<std::unique_ptr<PartInput>> parts;
  std::vector<std::unique_ptr<JoinedInput>> joined;
  std::vector<std::unique_ptr<SetInput>> sets;
  std::vector<std::unique_ptr<InitialStateInput>> initial_states;
  std::vector<std::unique_ptr<Boundary>> boundaries;
  std::vector<std::unique_ptr<Load>> loads;
  std::vector<std::unique_ptr<Contact>> contacts;
  std::vector<std::unique_ptr<Measure>> measures;
  std::vector<std::unique_ptr<Observer>> observers;
  BalanceInput balance;
  OutputInput output;
  ChecksInput checks;
  /// Fingerprint of the text of everything that a restart must find unchanged; not a key of the input.
  std::string digest;
  std::string end_origin;  // where time.end was written
  std::vector<std::string> warnings;  // about the text of the input
  std::vector<LibraryUse> library_uses;  // sets of the material library that are in their places already
  DeckNote deck;
  std::string source_report;  // what `kerf check` tells of a deck first; empty for other inputs
  std::string materials_text;  // the block `materials` with all sets written out; empty where none was named
  static void describe(Schema<ModelInput>& s);
  /// Whether loads, or observers, put forces on nodes.
  bool has_external_forces() const;
  ~ModelInput();
};

}  // namespace kerf
