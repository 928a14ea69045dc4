// Damage to the text of a deck, always the same for the same seed.
#pragma once

#include <algorithm>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace kerf::test {

/// One way to damage a deck, chosen by the generator. Numbers of std::mt19937 are the same everywhere, those of the
/// distributions of the standard library are not: hence the remainders.
class DeckDamage {
 public:
  explicit DeckDamage(unsigned seed) : random_(seed) {}

  std::string operator()(std::string text) {
    for (std::size_t n = 1 + below(3); n > 0 && !text.empty(); --n) damage(text);
    return text;
  }

 private:
  std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }

  /// Where a line begins, and how long it is with its end.
  std::pair<std::size_t, std::size_t> line(const std::string& text) {
    const std::size_t at = below(text.size());
    const std::size_t before = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
    const std::size_t start = before == std::string::npos ? 0 : before + 1;
    const std::size_t end = std::min(text.find('\n', start), text.size() - 1) + 1;
    return {start, end - start};
  }

  void damage(std::string& text) {
    static const std::vector<std::string> pieces = {"99999999999999999999",
                                                    "-1",
                                                    "1e308",
                                                    "1e-400",
                                                    "nan",
                                                    "&x",
                                                    "<1/0>",
                                                    "<((((((",
                                                    "\t",
                                                    ",,,,,,,,,",
                                                    "*END\n",
                                                    "*NODE %\n",
                                                    "*",
                                                    "$",
                                                    "\r",
                                                    "*KEYWORD LONG=Y\n",
                                                    "*INCLUDE\nbrick.k\n",
                                                    "0",
                                                    "*PARAMETER\nR x 1\n",
                                                    std::string(3, '\0'),
                                                    "*SET_NODE_LIST_GENERATE\n         9\n         1999999999\n",
                                                    "*CASE_BEGIN_3\n",
                                                    " +\n",
                                                    "*ELEMENT_SOLID\n",
                                                    "*DEFINE_TRANSFORMATION\n         1\nSCALE     1e300\n",
                                                    "I10=Y",
                                                    "_TITLE",
                                                    "_ID"};
    const auto [start, length] = line(text);
    switch (below(8)) {
      case 0:
        text.resize(below(text.size()));
        break;
      case 1:
        for (std::size_t k = 0; k < 1 + below(20); ++k) text[below(text.size())] ^= static_cast<char>(1 << below(8));
        break;
      case 2: {  // swaps two lines
        const std::string first = text.substr(start, length);
        text.erase(start, length);
        text.insert(text.empty() ? 0 : line(text).first, first);
        break;
      }
      case 3:
        text.insert(start, text.substr(start, std::min<std::size_t>(text.size() - start, 1 + below(2000))));
        break;
      case 4:
        text.erase(start, length);
        break;
      case 5:
        text.insert(below(text.size()), pieces[below(pieces.size())]);
        break;
      case 6:
        text.replace(start + below(length), std::min<std::size_t>(1 + below(12), text.size() - start - length + 1),
                     pieces[below(pieces.size())]);
        break;
      default:
        text[below(text.size())] = static_cast<char>(below(256));
    }
  }

  std::mt19937 random_;
};

}  // namespace kerf::test
