#pragma once
#include <string>
#include <vector>

namespace tape::report {
/// Rows of text under column names, for a terminal or a CSV file.
struct Table {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  ///< each as long as `columns`
};
/// Aligned columns, two spaces apart: numbers to the right, text to the left.
std::string to_text(const Table& table);
/// Comma-separated values, RFC 4180: quotes only where needed.
std::string to_csv(const Table& table);

/// A number for people: four significant digits.
std::string rounded(double value);
}  // namespace tape::report
