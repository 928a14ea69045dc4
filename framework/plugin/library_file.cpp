// Reads the tables of an ELF file; every place in the file that is followed was compared with its length.
#include "plugin/library_file.hpp"

#include <cxxabi.h>
#include <elf.h>
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <stdexcept>

namespace kerf {
namespace {

#if defined(__x86_64__)
constexpr int this_machine = EM_X86_64;
#elif defined(__aarch64__)
constexpr int this_machine = EM_AARCH64;
#else
constexpr int this_machine = EM_NONE;  // not compared
#endif

[[noreturn]] void refuse(const std::string& sentence) { throw std::runtime_error(sentence); }

[[noreturn]] void refuse_as_no_library(const std::string& what) {
  refuse(fmt::format("is {}, not a shared library; name the .so file that kerf_add_plugin() has made", what));
}

void require_within(std::uint64_t begin, std::uint64_t length, std::uint64_t size) {
  if (begin > size || length > size - begin)
    refuse(fmt::format("is not whole: it should have at least {} bytes and has {}; copy or build it again",
                       begin > UINT64_MAX - length ? UINT64_MAX : begin + length, size));
}

/// Hash of Fowler, Noll and Vo, of 64 bits: files that differ by accident share it once in 2^64.
std::uint64_t fnv1a(const std::string& bytes) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
}

/// Functions of the C++ library say nothing about who has called them.
bool is_of_standard_library(const std::string& name) {
  return name.rfind("_ZNSt", 0) == 0 || name.rfind("_ZNKSt", 0) == 0 || name.rfind("_ZSt", 0) == 0 ||
         name.rfind("_ZN9__gnu_cxx", 0) == 0;
}

}  // namespace

std::string demangled(const std::string& symbol) {
  int status = 0;
  const std::unique_ptr<char, decltype(&std::free)> text(abi::__cxa_demangle(symbol.c_str(), nullptr, nullptr, &status),
                                                         &std::free);
  return status == 0 && text ? text.get() : symbol;
}

LibraryFile::LibraryFile(const std::string& path) {
  std::error_code unknown;
  if (std::filesystem::is_directory(path, unknown)) refuse_as_no_library("a folder");
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream && errno == ENOENT) refuse("is not there; let all ranks and machines see the same file");
  if (!stream)
    refuse(fmt::format("cannot be read: {}; give the one who runs Kerf the right to read it", std::strerror(errno)));
  std::ostringstream text;
  text << stream.rdbuf();
  bytes_ = std::move(text).str();
  checksum_ = fnv1a(bytes_);
}

template <class T>
T LibraryFile::at(std::uint64_t offset) const {
  require_within(offset, sizeof(T), size());
  T value;
  std::memcpy(&value, bytes_.data() + offset, sizeof(T));
  return value;
}

void LibraryFile::require_whole() {
  if (bytes_.empty()) refuse_as_no_library("an empty file");
  if (bytes_.compare(0, SELFMAG, std::string(ELFMAG, std::min<std::size_t>(SELFMAG, size()))) != 0)
    refuse_as_no_library("a file of another kind");
  const auto header = at<Elf64_Ehdr>(0);
  const int order = std::endian::native == std::endian::little ? ELFDATA2LSB : ELFDATA2MSB;
  if (header.e_ident[EI_CLASS] != ELFCLASS64 || header.e_ident[EI_DATA] != order ||
      (this_machine != EM_NONE && header.e_machine != this_machine))
    refuse("is a library for machines of another kind; build it on this one");
  if (header.e_type != ET_DYN) refuse_as_no_library("a program or an object file");
  for (std::uint64_t i = 0; i < header.e_phnum; ++i) {
    const auto segment = at<Elf64_Phdr>(header.e_phoff + i * sizeof(Elf64_Phdr));
    require_within(segment.p_offset, segment.p_filesz, size());
  }
  if (header.e_shoff == 0 || header.e_shnum == 0)
    refuse("has no table of its sections, which Kerf reads; build it again without removing them");
  for (std::uint64_t i = 0; i < header.e_shnum; ++i) {
    const auto section = at<Elf64_Shdr>(header.e_shoff + i * sizeof(Elf64_Shdr));
    if (section.sh_type != SHT_NOBITS) require_within(section.sh_offset, section.sh_size, size());
  }
  dynamic_ = table_of(SHT_DYNSYM);
  all_ = table_of(SHT_SYMTAB);
}

LibraryFile::Table LibraryFile::table_of(std::uint32_t type) const {
  const auto header = at<Elf64_Ehdr>(0);
  for (std::uint64_t i = 0; i < header.e_shnum; ++i) {
    const auto section = at<Elf64_Shdr>(header.e_shoff + i * sizeof(Elf64_Shdr));
    if (section.sh_type != type || section.sh_link >= header.e_shnum) continue;
    const auto names = at<Elf64_Shdr>(header.e_shoff + section.sh_link * sizeof(Elf64_Shdr));
    require_within(names.sh_offset, names.sh_size, size());
    return {section.sh_offset, section.sh_size / sizeof(Elf64_Sym), names.sh_offset, names.sh_offset + names.sh_size};
  }
  return {};
}

std::string LibraryFile::name_at(const Table& table, std::uint64_t offset) const {
  if (offset >= table.names_end - table.names) return {};
  const char* begin = bytes_.data() + table.names + offset;
  return {begin, strnlen(begin, table.names_end - table.names - offset)};
}

template <class Use>
void LibraryFile::each_symbol(const Table& table, const Use& use) const {
  for (std::uint64_t i = 0; i < table.n; ++i) {
    const auto symbol = at<Elf64_Sym>(table.begin + i * sizeof(Elf64_Sym));
    if (symbol.st_shndx != SHN_UNDEF) use(symbol, name_at(table, symbol.st_name));
  }
}

bool LibraryFile::has_symbol(const std::string& name) const {
  bool found = false;
  each_symbol(dynamic_, [&](const Elf64_Sym&, const std::string& n) { found |= n == name; });
  return found;
}

std::optional<std::string> LibraryFile::text_of(const std::string& name) const {
  std::optional<std::string> text;
  const auto header = at<Elf64_Ehdr>(0);
  each_symbol(dynamic_, [&](const Elf64_Sym& symbol, const std::string& n) {
    if (n != name) return;
    for (std::uint64_t i = 0; i < header.e_phnum; ++i) {
      const auto segment = at<Elf64_Phdr>(header.e_phoff + i * sizeof(Elf64_Phdr));
      const std::uint64_t place = symbol.st_value - segment.p_vaddr;  // wraps around below the segment
      if (segment.p_type != PT_LOAD || place >= segment.p_filesz) continue;
      const char* begin = bytes_.data() + segment.p_offset + place;
      text.emplace(begin, strnlen(begin, std::min<std::uint64_t>(symbol.st_size, segment.p_filesz - place)));
    }
  });
  return text;
}

std::vector<LibraryFunction> LibraryFile::functions() const {
  std::vector<LibraryFunction> found;
  each_symbol(all_.n > 0 ? all_ : dynamic_, [&](const Elf64_Sym& symbol, const std::string& name) {
    if (ELF64_ST_TYPE(symbol.st_info) == STT_FUNC && symbol.st_size > 0 && !is_of_standard_library(name))
      found.push_back({symbol.st_value, symbol.st_value + symbol.st_size, demangled(name)});
  });
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.begin < b.begin; });
  return found;
}

}  // namespace kerf
