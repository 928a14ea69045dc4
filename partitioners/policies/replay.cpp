// The policy that repeats what another run has decided.
#include <kerf/balance_policy.hpp>

#include <algorithm>
#include <charconv>
#include <numeric>

namespace {

using namespace kerf;

struct Replay final : BalancePolicy {
  std::string file;

  static void describe(Schema<Replay>& s) {
    s.text(&Replay::file, "file",
           "balance.csv of the run whose re-balances are repeated, named relative to the input "
           "file");
  }

  std::vector<std::string> prepare(const InputFiles& files) override {
    cycles_.clear();
    if (file.empty()) return {};  // reported already
    std::string path, failure;
    const std::string text = files.read(file, path, failure);
    if (!failure.empty())
      return {origin + ": error: the file \"" + path + "\" cannot be read: " + failure +
              "; expected a balance.csv, named relative to the input file"};
    return read(path, text);
  }
  /// Of all cycles in which the mesh has moved; others do not cost anything.
  std::int64_t check_interval() const override {
    std::int64_t interval = 0;
    for (const std::int64_t cycle : cycles_) interval = std::gcd(interval, cycle);
    return interval;
  }
  bool move(const BalanceState& now) override { return std::binary_search(cycles_.begin(), cycles_.end(), now.cycle); }
  BalanceReasons reasons() const override {
    BalanceReasons r;
    r.reason = "recorded";
    return r;
  }

 private:
  static std::vector<std::string> fields_of(const std::string& line) {
    std::vector<std::string> fields{""};
    for (const char c : line)
      if (c == ',')
        fields.emplace_back();
      else if (c != '\r')
        fields.back() += c;
    return fields;
  }

  /// Takes the cycles of all moves. Returns what is wrong.
  std::vector<std::string> read(const std::string& path, const std::string& text) {
    std::vector<std::string> errors;
    std::size_t cycle_column = 0, decision_column = 0, n_columns = 0, line_number = 0;
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t end = std::min(text.find('\n', at), text.size());
      const std::vector<std::string> fields = fields_of(text.substr(at, end - at));
      at = end + 1;
      const std::string place = path + ":" + std::to_string(++line_number) + ":1: error: ";
      if (line_number == 1) {
        const auto column = [&](const char* name) {
          return static_cast<std::size_t>(std::find(fields.begin(), fields.end(), name) - fields.begin());
        };
        cycle_column = column("cycle");
        decision_column = column("decision");
        n_columns = fields.size();
        if (cycle_column == n_columns || decision_column == n_columns)
          return {place + "there are no columns `cycle` and `decision`; expected the heading of a balance.csv"};
        continue;
      }
      std::int64_t cycle = 0;
      if (fields.size() != n_columns) {
        errors.push_back(place + "the line has " + std::to_string(fields.size()) + " fields; expected " +
                         std::to_string(n_columns) + ", as many as the heading");
        continue;
      }
      const std::string& number = fields[cycle_column];
      const std::string& decision = fields[decision_column];
      const auto [rest, trouble] = std::from_chars(number.data(), number.data() + number.size(), cycle);
      if (trouble != std::errc() || rest != number.data() + number.size() || cycle < 0)
        errors.push_back(place + "\"" + number + "\" is no cycle; expected a whole number");
      else if (decision == "move" || decision == "forced")
        cycles_.push_back(cycle);
      else if (decision != "stay" && decision != "first" && decision != "resumed")
        errors.push_back(place + "\"" + decision + "\" is no decision; expected move, forced, stay, first or resumed");
    }
    if (line_number == 0) errors.push_back(path + ":1:1: error: the file is empty; expected a balance.csv");
    if (!std::is_sorted(cycles_.begin(), cycles_.end()))
      errors.push_back(path + ":1:1: error: the cycles do not ascend; expected the rows of one run");
    return errors;
  }

  std::vector<std::int64_t> cycles_;  // ascending
};

}  // namespace

KERF_BALANCE_POLICY(Replay, "replay", "repeats the re-balances that another run has recorded in its balance.csv")
