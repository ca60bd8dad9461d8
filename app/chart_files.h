#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "app/report/page.h"

namespace osteon::app {

/// What a chart is named after: processor, cores, system.
[[nodiscard]] std::string MachineName();

/// "OPTION FOLDER: found a file, accepted a folder"; empty where the name is free, or a folder's.
[[nodiscard]] std::string WhyNoFolder(const char* option, const std::filesystem::path& folder);

/// "OPTION FILE: no folder FOLDER"; empty where the folder that it is to be in is there, or no file is named.
[[nodiscard]] std::string WhyNoParent(const char* option, const std::filesystem::path& file);

/// The same, or "OPTION FILE: found a folder, accepted a file".
[[nodiscard]] std::string WhyNoFile(const char* option, const std::filesystem::path& file);

/// FILE.svg and FILE.png. @returns an error that names the file.
[[nodiscard]] tl::expected<void, std::string> WriteDrawing(const std::string& svg,
                                                           const std::filesystem::path& file);

/// A chart in its five forms, beside each other in one folder.
struct ChartFiles {
  std::string name;   ///< of the files, without an extension
  std::string title;  ///< of the page
  ReportVerdict verdict;
  std::string svg;
  std::string caption;
  std::string csv;
  std::string json;
  std::filesystem::path json_copy;              ///< a further copy of the JSON; empty: none
  std::vector<std::vector<std::string>> table;  ///< the first row names the columns; the first column is text
  std::vector<std::string> notes;               ///< paragraphs below the chart
};

/// Writes NAME.svg, .png, .csv, .json, .html; each appears whole or not at all. Makes the folder.
/// @returns an error that names the file.
[[nodiscard]] tl::expected<void, std::string> WriteChart(const ChartFiles& chart,
                                                         const std::filesystem::path& folder);

}  // namespace osteon::app
