// Objects of the four kinds of laws that hand their blocks to Python.
#include "plugin/prototype.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <limits>
#include <memory>

#include "kerf/eos.hpp"
#include "kerf/erosion.hpp"
#include "kerf/law_use.hpp"
#include "kerf/material.hpp"
#include "kerf/solid.hpp"
#include "plugin/prototype_host.hpp"

namespace kerf {

namespace {

/// What the laws of one registered type share.
struct PrototypeType {
  std::shared_ptr<PrototypeHost> host;
  int law = 0;  // its place in the file
  unsigned inputs = 0;
  bool uses_energy = true, softens = false;
};

/// Rows of a block on their way to Python, and back.
class Numbers {
 public:
  explicit Numbers(const LawRows& rows) { all_ = {rows.dt, rows.time}; }
  void add(double value) { all_.push_back(value); }
  void add(const double* row) { all_.insert(all_.end(), row, row + lane_width); }
  template <std::size_t n>
  void add(const double (*rows)[lane_width], std::integral_constant<std::size_t, n>) {
    for (std::size_t r = 0; r < n; ++r) add(rows[r]);
  }
  void add_asked(const LawRows& rows, unsigned inputs) {
    if ((inputs & with_length) != 0) add(rows.length);
    if ((inputs & with_initial_length) != 0) add(rows.initial_length);
    if ((inputs & with_reference_position) != 0) add(rows.reference_position, std::integral_constant<std::size_t, 3>{});
    if ((inputs & with_rotation) != 0) add(rows.rotation, std::integral_constant<std::size_t, 9>{});
  }
  const std::vector<double>& all() const { return all_; }

 private:
  std::vector<double> all_;
};

constexpr std::integral_constant<std::size_t, 6> six;
constexpr std::integral_constant<std::size_t, 9> nine;

/// Takes rows from an answer, one after the other.
class Answer {
 public:
  explicit Answer(std::vector<double> all) : all_(std::move(all)) {}
  /// To be called when all rows have been taken.
  void end() const {
    if (at_ != all_.size()) throw std::runtime_error("Python has answered with too many numbers");
  }
  void take(double* row) {
    if (at_ + lane_width > all_.size()) throw std::runtime_error("Python has answered with too few numbers");
    for (int l = 0; l < lane_width; ++l) row[l] = all_[at_++];
  }

 private:
  std::vector<double> all_;
  std::size_t at_ = 0;
};

/// The part of a prototype that is not of its kind. `Base` is the class of the kind.
template <class Base>
class Prototype : public Base, public WarningLaw {
 public:
  explicit Prototype(std::shared_ptr<const PrototypeType> of) : of_(std::move(of)) {}
  nlohmann::json values = nlohmann::json::object();  // of the parameters, by name
  unsigned asked_inputs() const final { return of_->inputs; }
  double cost() const final { return 1000.0; }
  std::vector<std::string> warnings(LawUse&) const override {
    return {
        "the law is a prototype in Python: a thousand times slower than a compiled one, and its bits are those of "
        "NumPy on this machine"};
  }

 protected:
  Answer compute(const Numbers& numbers) const {
    if (object_ < 0) object_ = of_->host->make(of_->law, values);
    return Answer(of_->host->compute(object_, numbers.all()));
  }
  void add_state_and_reads(Numbers& n, const LawRows& rows, const double* state) const {
    n.add_asked(rows, of_->inputs);
    for (std::size_t v = 0; v < this->state_variables().size(); ++v) n.add(state + v * lane_width);
    for (std::size_t r = 0; r < this->reads().size(); ++r) n.add(rows.reads[r]);
  }
  void take_state(Answer& answer, double* state) const {
    for (std::size_t v = 0; v < this->state_variables().size(); ++v) answer.take(state + v * lane_width);
    answer.end();
  }
  const PrototypeType& of() const { return *of_; }

 private:
  std::shared_ptr<const PrototypeType> of_;
  mutable int object_ = -1;  // in Python; made when the parameters are known
};

class PrototypeMaterial final : public Prototype<Material> {
 public:
  using Prototype::Prototype;
  void update(const MaterialBatch& b) const override {
    Numbers n(b);
    n.add(b.reference_density);
    n.add(b.strain_increment, six);
    n.add(b.density);
    n.add(b.specific_energy);
    n.add(b.pressure);
    for (int i = 0; i < 6; ++i) n.add(b.deviator[i]);
    add_state_and_reads(n, b, b.state);
    Answer answer = compute(n);
    for (int i = 0; i < 6; ++i) answer.take(b.deviator[i]);
    answer.take(b.shear_modulus);
    take_state(answer, b.state);
  }
};

class PrototypeSolid final : public Prototype<Solid> {
 public:
  using Prototype::Prototype;
  void update(const SolidBatch& b) const override {
    Numbers n(b);
    n.add(b.reference_density);
    n.add(b.strain_increment, six);
    n.add(b.density);
    n.add(b.specific_energy);
    double stress[6][lane_width];
    for (int i = 0; i < 6; ++i)
      for (int l = 0; l < lane_width; ++l) stress[i][l] = b.deviator[i][l] - (i < 3 ? b.pressure[l] : 0.0);
    n.add(stress, six);
    add_state_and_reads(n, b, b.state);
    Answer answer = compute(n);
    for (auto& row : stress) answer.take(row);
    answer.take(b.shear_modulus);
    answer.take(b.bulk_modulus);
    take_state(answer, b.state);
    for (int l = 0; l < lane_width; ++l) {
      b.pressure[l] = -(stress[0][l] + stress[1][l] + stress[2][l]) / 3.0;
      for (int i = 0; i < 6; ++i) b.deviator[i][l] = stress[i][l] + (i < 3 ? b.pressure[l] : 0.0);
    }
  }
};

class PrototypeEos final : public Prototype<Eos> {
 public:
  using Prototype::Prototype;
  bool uses_energy() const override { return of().uses_energy; }
  void evaluate(const EosBatch& b) const override {
    Numbers n(b);
    n.add(b.reference_density);
    n.add(b.density);
    n.add(b.specific_energy);
    add_state_and_reads(n, b, b.state);
    Answer answer = compute(n);
    answer.take(b.pressure);
    answer.take(b.bulk_modulus);
    if (b.new_state != nullptr) take_state(answer, b.new_state);
  }
};

class PrototypeErosion final : public Prototype<ErosionCriterion> {
 public:
  using Prototype::Prototype;
  static void describe(Schema<PrototypeErosion>& s) { describe_interval(s); }
  bool softens() const override { return of().softens; }
  void judge(const ErosionBatch& b) const override {
    Numbers n(b);
    n.add(b.stress, six);
    n.add(b.strain_increment, six);
    n.add(b.rotation, nine);
    for (const double* row : {b.pressure, b.density_ratio, b.volume_ratio, b.time_step}) n.add(row);
    add_state_and_reads(n, b, b.state);
    Answer answer = compute(n);
    answer.take(b.value);
    answer.take(b.failed);
    if (of().softens)
      for (double* row : {b.strength, b.tension, b.compression}) answer.take(row);
    take_state(answer, b.state);
  }
};

double bound(const nlohmann::json& value, double absent) { return value.is_null() ? absent : value.get<double>(); }

Range range_of(const nlohmann::json& p) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {bound(p.at("low"), -infinity), bound(p.at("high"), infinity), p.at("low_open"), p.at("high_open")};
}

/// Parameters, state and reads as a file declares them. `Type` is the class of the kind.
template <class Type>
Description description_of(const nlohmann::json& law, const std::string& origin) {
  Description d;
  d.kind = law.at("kind");
  d.name = law.at("name");
  d.summary = law.at("summary");
  d.origin = origin;
  for (const nlohmann::json& p : law.at("parameters")) {
    Parameter parameter;
    parameter.name = p.at("name");
    parameter.unit = p.at("unit");
    parameter.doc = p.at("doc");
    parameter.range = range_of(p);
    parameter.required = p.at("default").is_null();
    if (!parameter.required) parameter.default_text = p.at("default");
    parameter.set_real = [name = parameter.name](void* target, double value) {
      static_cast<Type*>(target)->values[name] = value;
    };
    d.parameters.push_back(std::move(parameter));
  }
  for (const nlohmann::json& s : law.at("state")) {
    StateVariable v;
    v.name = s.at("name");
    v.unit = s.at("unit");
    v.doc = s.at("doc");
    v.initial = s.at("initial");
    v.index = static_cast<int>(d.state.size());
    v.begins_tensor = s.at("begins_tensor");
    d.state.push_back(std::move(v));
  }
  for (const nlohmann::json& r : law.at("reads")) {
    ReadVariable v;
    v.name = r.at("name");
    v.doc = r.at("doc");
    v.index = static_cast<int>(d.reads.size());
    v.is_optional = !r.at("default").is_null();
    v.value = bound(r.at("default"), 0.0);
    d.reads.push_back(std::move(v));
  }
  return d;
}

template <class Type>
void add_law(const nlohmann::json& law, const std::shared_ptr<const PrototypeType>& of, const std::string& origin,
             Registry& registry) {
  Description d = description_of<Type>(law, origin);
  if constexpr (std::is_same_v<Type, PrototypeErosion>) {
    Description common;
    Schema<Type> schema(common);
    Type::describe(schema);
    for (Parameter& p : common.parameters) d.parameters.push_back(std::move(p));
  }
  registry.add_made(std::move(d), [of] {
    auto object = std::make_unique<Type>(of);
    void* address = object.get();
    return Made{std::move(object), address};
  });
}

}  // namespace

bool is_prototype(const std::string& path) { return path.ends_with(".py"); }

void load_prototype(const std::string& path, Registry& registry) {
  const auto host = std::make_shared<PrototypeHost>(path);
  for (std::size_t i = 0; i < host->laws().size(); ++i) {
    const nlohmann::json& law = host->laws()[i];
    auto of = std::make_shared<PrototypeType>();
    of->host = host;
    of->law = static_cast<int>(i);
    of->inputs = law.at("inputs");
    of->uses_energy = law.at("uses_energy");
    of->softens = law.at("softens");
    const std::string kind = law.at("kind");
    if (kind == "material") add_law<PrototypeMaterial>(law, of, path, registry);
    if (kind == "solid") add_law<PrototypeSolid>(law, of, path, registry);
    if (kind == "eos") add_law<PrototypeEos>(law, of, path, registry);
    if (kind == "erosion") add_law<PrototypeErosion>(law, of, path, registry);
  }
}

}  // namespace kerf
