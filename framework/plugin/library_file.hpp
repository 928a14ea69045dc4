// A shared library as bytes of a file: what can be known of it before the loader of the system touches it. A damaged
// library may end the program in the loader, and loading runs the library's own code.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace kerf {

/// The name of a symbol as C++ writes it; the symbol itself where it is none of C++.
std::string demangled(const std::string& symbol);

/// A function of a library, by its place above the address that the library is loaded at.
struct LibraryFunction {
  std::uint64_t begin = 0, end = 0;
  std::string name;  // as C++ writes it
};

class LibraryFile {
 public:
  /// Reads the whole file. Throws std::runtime_error with half a sentence: what is wrong; what to do.
  explicit LibraryFile(const std::string& path);

  std::size_t size() const { return bytes_.size(); }
  std::uint64_t checksum() const { return checksum_; }
  /// Throws std::runtime_error as above where the file is no whole shared library for this machine.
  void require_whole();

  // Pre, from here on: require_whole() did not throw.
  bool has_symbol(const std::string& name) const;
  /// The text that a symbol of constant data stands for, up to its end or a zero; nothing where there is no such
  /// symbol.
  std::optional<std::string> text_of(const std::string& name) const;
  /// The functions of the library by place, but those of the C++ library.
  std::vector<LibraryFunction> functions() const;

 private:
  struct Table {
    std::uint64_t begin = 0, n = 0;  // entries of symbols, from this byte of the file on
    std::uint64_t names = 0, names_end = 0;
  };
  template <class T>
  T at(std::uint64_t offset) const;
  std::string name_at(const Table& table, std::uint64_t offset) const;
  Table table_of(std::uint32_t type) const;
  template <class Use>
  void each_symbol(const Table& table, const Use& use) const;

  std::string bytes_;
  std::uint64_t checksum_ = 0;
  Table dynamic_, all_;
};

}  // namespace kerf
