#include "host/io/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "host/error.h"
#include "host/io/printable.h"
#include "host/scene/scene_checks.h"

namespace scree {
namespace {

constexpr std::size_t kShown = 40;  // bytes of a file's own words in a message

std::string_view trimmed(std::string_view text) {
  const char* blank = " \t\r";
  const std::size_t first = text.find_first_not_of(blank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

}  // namespace

CsvLines::CsvLines(std::filesystem::path file, std::size_t most_cells)
    : file_(std::move(file)), stream_(file_, std::ios::binary), most_cells_(most_cells) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file_, error))
    throw InputError(file_.string() + ": no such file");
  if (!stream_) throw InputError(file_.string() + ": cannot be read");
}

bool CsvLines::next() {
  while (std::getline(stream_, line_)) {
    ++line_number_;
    if (line_number_ == 1 && line_.compare(0, 3, "\xEF\xBB\xBF") == 0) line_.erase(0, 3);
    const std::string_view text = trimmed(line_);
    if (text.empty() || text.front() == '#') continue;
    split();
    return true;
  }
  if (stream_.bad()) throw InputError(file_.string() + ": cannot be read to its end");
  return false;
}

void CsvLines::split() {
  cells_.clear();
  std::string_view rest = line_;
  for (;;) {
    const std::size_t comma = rest.find(',');
    cells_.push_back(trimmed(rest.substr(0, comma)));
    if (comma == std::string_view::npos) return;
    if (cells_.size() == most_cells_) fail(fmt::format("more than {} values", most_cells_));
    rest.remove_prefix(comma + 1);
  }
}

std::optional<double> CsvLines::number(std::size_t cell) const {
  std::string_view text = cells_[cell];
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

void CsvLines::refuse(std::size_t cell, const std::string& column,
                      const std::string& expected) const {
  const std::string value = fmt::format("\"{}\"", printable(cells_[cell], kShown));
  throw InputError(fault_text(fmt::format("{}: line {}, {}", file_.string(), line_number_, column),
                              value, expected));
}

void CsvLines::fail(const std::string& text) const {
  throw InputError(fmt::format("{}: line {}: {}", file_.string(), line_number_, text));
}

CsvReader::CsvReader(std::filesystem::path file, const std::vector<std::string>& known)
    : lines_(std::move(file)) {
  if (!lines_.next())
    throw InputError(lines_.file().string() + ": empty: the first line must name columns");
  for (const std::string_view cell : lines_.cells()) columns_.emplace_back(cell);
  std::string list;
  for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
  const auto is_known = [&](const std::string& name) {
    return std::find(known.begin(), known.end(), name) != known.end();
  };
  // A file that holds something else shows none of it.
  if (std::none_of(columns_.begin(), columns_.end(), is_known))
    fail("no table: names none of the known columns: " + list);
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (!is_known(columns_[i]))
      fail(fmt::format("unknown column \"{}\". Known columns: {}", printable(columns_[i], kShown),
                       list));
    if (std::find(columns_.begin(), columns_.begin() + static_cast<std::ptrdiff_t>(i),
                  columns_[i]) != columns_.begin() + static_cast<std::ptrdiff_t>(i))
      fail(fmt::format("column \"{}\" is given twice", columns_[i]));
  }
}

int CsvReader::find(const std::string& column) const {
  const auto at = std::find(columns_.begin(), columns_.end(), column);
  return at == columns_.end() ? -1 : static_cast<int>(at - columns_.begin());
}

int CsvReader::require(const std::string& column) const {
  const int at = find(column);
  if (at < 0)
    throw InputError(fmt::format("{}: column \"{}\" is missing", lines_.file().string(), column));
  return at;
}

std::size_t CsvReader::line_count() const {
  std::ifstream stream(lines_.file(), std::ios::binary);
  std::vector<char> block(std::size_t{1} << 20);
  std::size_t count = 1;
  do {
    stream.read(block.data(), static_cast<std::streamsize>(block.size()));
    count +=
        static_cast<std::size_t>(std::count(block.begin(), block.begin() + stream.gcount(), '\n'));
  } while (stream);
  return count;
}

bool CsvReader::next() {
  if (!lines_.next()) return false;
  const std::size_t count = lines_.cells().size();
  if (count != columns_.size())
    fail(fmt::format("{} values, but the header names {} columns", count, columns_.size()));
  return true;
}

std::string CsvReader::name_of(int column) const {
  return fmt::format("column \"{}\"", columns_[static_cast<std::size_t>(column)]);
}

double CsvReader::number(int column) const {
  if (const auto value = lines_.number(static_cast<std::size_t>(column))) return *value;
  refuse(column, "must be a finite number");
}

void CsvReader::refuse(int column, const std::string& expected) const {
  lines_.refuse(static_cast<std::size_t>(column), name_of(column), expected);
}

}  // namespace scree
