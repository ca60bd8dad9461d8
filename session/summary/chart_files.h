#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "report/page.h"

namespace osteon::session {

/// Returns the machine's name for a chart: processor, cores, system.
[[nodiscard]] std::string MachineName();

/// Returns "OPTION FOLDER: found a file, accepted a folder"; empty if nothing has this name, or a folder has
/// it.
[[nodiscard]] std::string ValidateOutputFolder(const char* option, const std::filesystem::path& folder);

/// Returns "OPTION FILE: no folder FOLDER"; empty if the file's folder exists, or no file is named.
[[nodiscard]] std::string ValidateParentFolder(const char* option, const std::filesystem::path& file);

/// Does the checks of ValidateParentFolder, and returns "OPTION FILE: found a folder, accepted a file" if
/// `file` is a folder.
[[nodiscard]] std::string ValidateOutputFile(const char* option, const std::filesystem::path& file);

/// Writes FILE.svg and FILE.png. @returns an error that names the file.
[[nodiscard]] tl::expected<void, std::string> WriteDrawing(const std::string& svg,
                                                           const std::filesystem::path& file);

/// A further part of a chart's page: a picture, a table, or both.
struct ChartPart {
  std::string heading;
  std::string name{};  ///< name of the picture's files, without an extension; empty: no picture
  std::string svg{};
  std::string caption{};
  std::vector<std::vector<std::string>> table{};  ///< like ChartFiles::table; empty: no table
};

/// A chart that is written in five file formats into one folder.
struct ChartFiles {
  std::string name;   ///< name of the files, without an extension
  std::string title;  ///< title of the page
  report::ReportVerdict verdict;
  std::string svg;
  std::string caption;
  std::string csv;
  std::string json;
  std::filesystem::path json_copy;              ///< a second copy of the JSON; empty: none
  std::vector<std::vector<std::string>> table;  ///< the first row names the columns; the first column is text
  std::vector<std::string> notes;               ///< paragraphs below the chart
  std::vector<ChartPart> parts{};               ///< further parts below the table
};

/// Writes NAME.svg, .png, .csv, .json, .html, and a .svg and .png for each part with a picture; each file
/// appears complete or not at all. Creates the folder.
/// @returns an error that names the file.
[[nodiscard]] tl::expected<void, std::string> WriteChart(const ChartFiles& chart,
                                                         const std::filesystem::path& folder);

}  // namespace osteon::session
