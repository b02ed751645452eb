#include "host/io/steps_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <string_view>
#include <type_traits>
#include <utility>

#include "host/error.h"

namespace scree {
namespace {

using Columns = std::span<const ReportColumn>;

std::string header(Columns columns) {
  std::string line;
  for (const ReportColumn& column : columns) {
    if (!line.empty()) line += ',';
    line += column.name;
  }
  return line + '\n';
}

/// Shortest text that reads back as the same number; true and false as 1 and 0; nothing for no value.
void append_line(std::string& out, Columns columns, const StepReport& report) {
  const char* separator = "";
  for (const ReportColumn& column : columns) {
    with_value(column, report, [&](auto value) {
      if constexpr (std::is_same_v<decltype(value), bool>)
        fmt::format_to(std::back_inserter(out), "{}{}", separator, value ? 1 : 0);
      else if (static_cast<double>(value) == kNoValue)
        out += separator;
      else
        fmt::format_to(std::back_inserter(out), "{}{}", separator, value);
    });
    separator = ",";
  }
  out += '\n';
}

/// The field up to the next comma; shortens the line to what follows.
std::string_view take_field(std::string_view& line) {
  const std::size_t comma = line.find(',');
  const std::string_view field = line.substr(0, comma);
  line.remove_prefix(comma == std::string_view::npos ? line.size() : comma + 1);
  return field;
}

template <class T>
bool parse(std::string_view text, T* value) {
  if constexpr (std::is_same_v<T, bool>) {
    *value = text == "1";
    return text == "0" || text == "1";
  } else {
    if constexpr (std::is_same_v<T, double>) {
      if (text.empty()) {
        *value = kNoValue;
        return true;
      }
    }
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *value);
    return error == std::errc() && end == text.data() + text.size();
  }
}

[[noreturn]] void refuse(const std::filesystem::path& path, std::size_t line_number,
                         const std::string& what) {
  throw InputError(fmt::format("{} line {}: {}", path.string(), line_number, what));
}

/// The columns that a header names: a file of an earlier version may lack some.
/// @throws InputError when one is not known or comes twice, or the first is not the number of the step
std::vector<ReportColumn> named_columns(const std::filesystem::path& path, std::string_view line,
                                        Columns known) {
  std::vector<ReportColumn> named;
  const auto refuse_all = [&] {
    std::string expected = header(known);
    expected.pop_back();
    refuse(path, 1,
           fmt::format(
               "found the columns \"{}\", expected \"{}\", or the first and some of the others",
               line, expected));
  };
  const auto of_name = [](std::string_view name) {
    return [name](const ReportColumn& column) { return column.name == name; };
  };
  for (std::string_view rest = line; !rest.empty();) {
    const std::string_view name = take_field(rest);
    const auto column = std::find_if(known.begin(), known.end(), of_name(name));
    const bool is_new = std::none_of(named.begin(), named.end(), of_name(name));
    const bool is_step = column == known.begin();
    if (column == known.end() || !is_new || is_step != named.empty()) refuse_all();
    named.push_back(*column);
  }
  if (named.empty() || line.ends_with(',')) refuse_all();
  return named;
}

/// Calls visit(line number, offset of the next line, line) for each whole line but the header,
/// until visit returns false.
/// @return  the columns of the file; those that are known where it has no whole header
template <class Visit>
std::vector<ReportColumn> for_each_line(const std::filesystem::path& path, Columns known,
                                        Visit visit) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(fmt::format("cannot read {}", path.string()));
  std::vector<ReportColumn> columns(known.begin(), known.end());
  std::string line;
  std::size_t line_number = 0;
  std::uint64_t offset = 0;
  while (std::getline(in, line) && !in.eof()) {  // a line without its end was torn by a kill
    offset += line.size() + 1;
    line_number += 1;
    if (line_number == 1)
      columns = named_columns(path, line, known);
    else if (!visit(Columns(columns), line_number, offset, std::string_view(line)))
      break;
  }
  return columns;
}

/// How a file goes on after a step.
struct Continuation {
  std::vector<ReportColumn> columns;
  std::uint64_t kept_bytes = 0;
  std::int64_t missing_steps = 0;
};

/// @throws InputError when it cannot
Continuation continuation(const std::filesystem::path& path, Columns known,
                          std::optional<std::int64_t> resume_step) {
  Continuation out{{known.begin(), known.end()}, 0, resume_step.value_or(0)};
  if (!resume_step || !std::filesystem::exists(path)) return out;
  std::int64_t last = 0;
  const auto keep = [&](Columns, std::size_t number, std::uint64_t end, std::string_view line) {
    std::int64_t step = 0;
    if (!parse(take_field(line), &step)) refuse(path, number, "expected the number of a step");
    if (step <= last) refuse(path, number, fmt::format("step {} comes after step {}", step, last));
    if (step > *resume_step) return false;
    last = step;
    out.missing_steps -= 1;
    out.kept_bytes = end;
    return true;
  };
  std::vector<ReportColumn> columns = for_each_line(path, known, keep);
  if (out.kept_bytes > 0) out.columns = std::move(columns);  // else it starts with a new header
  return out;
}

}  // namespace

void check_steps_csv(const std::filesystem::path& path, Columns columns, std::int64_t resume_step) {
  continuation(path, columns, resume_step);
}

StepsCsv::StepsCsv(std::filesystem::path path, Columns columns,
                   std::optional<std::int64_t> resume_step) {
  Continuation start = continuation(path, columns, resume_step);
  columns_ = std::move(start.columns);
  missing_steps_ = start.missing_steps;
  file_.emplace(std::move(path), start.kept_bytes, header(columns_));
}

void StepsCsv::append(const StepReport& report) {
  append_line(file_->pending(), columns_, report);
  file_->line_done();
}

std::vector<StepReport> read_steps_csv(const std::filesystem::path& path, Columns columns) {
  std::vector<StepReport> reports;
  const auto read = [&](Columns found, std::size_t number, std::uint64_t, std::string_view line) {
    StepReport report;
    for (const ReportColumn& column : found) {
      const std::string_view field = take_field(line);
      with_value(column, report, [&](auto& value) {
        if (!parse(field, &value))
          refuse(path, number,
                 fmt::format("column {} holds \"{}\", expected a number", column.name, field));
      });
    }
    if (!line.empty()) refuse(path, number, "there are more values than columns");
    reports.push_back(report);
    return true;
  };
  for_each_line(path, columns, read);
  return reports;
}

}  // namespace scree
