#include "importer/study/study.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "importer/bake/bake_folder.h"
#include "importer/btf/baked_files.h"
#include "importer/tile/tile.h"

namespace loden::importer {

StudyRow& StudyRow::set(std::string key, std::string value) {
  cells_.emplace_back(std::move(key), std::move(value));
  return *this;
}

StudyRow& StudyRow::set(std::string key, double value) {
  cells_.emplace_back(std::move(key), value);
  return *this;
}

StudyRow& StudyRow::set(std::string key, int64_t value) {
  cells_.emplace_back(std::move(key), value);
  return *this;
}

const StudyValue* StudyRow::find(std::string_view key) const {
  for (const auto& [name, value] : cells_)
    if (name == key) return &value;
  return nullptr;
}

std::string studyTileName(const std::string& tile) {
  const auto& builtin = builtinTileNames();
  return std::find(builtin.begin(), builtin.end(), tile) != builtin.end() ? "builtin:" + tile : tile;
}

namespace {

std::filesystem::path bakeFolder(const StudyOptions& options, const std::string& tile,
                                 const StudyBake& bake) {
  std::string name = std::filesystem::path(tile).stem().string() + "-" + std::to_string(options.size);
  if (bake.flat_size != 0 && bake.flat_size != options.size) name += "-flat" + std::to_string(bake.flat_size);
  if (bake.supersample != StudyBake{}.supersample) name += "-s" + std::to_string(bake.supersample);
  if (bake.texels == TexelMethod::kLinear) name += "-linear";
  if (bake.fill != FillMethod::kPushPull) name += std::string("-") + fillName(bake.fill);
  return options.bakes / name;
}

bool serves(const BakeManifest& m, const StudyOptions& options, const StudyBake& bake, const Tile& tile) {
  return m.revision == kBakeRevision && m.size == options.size &&
         (bake.flat_size ? m.flat_size == bake.flat_size : m.flat_size >= options.size) &&
         m.supersample == bake.supersample && m.fill == bake.fill && m.texels == bake.texels &&
         m.has_btf >= bake.maps.btf && m.has_flat >= bake.maps.flat && m.has_vdim >= bake.maps.vdim &&
         m.has_surface >= bake.maps.surface && m.directions.samples == bonn81Directions().samples &&
         m.input_hash == tileHash(tile);
}

}  // namespace

Result<BakedOutput> studyBake(const StudyOptions& options, const std::string& tile, const StudyBake& wanted) {
  const std::filesystem::path folder = bakeFolder(options, tile, wanted);
  const std::string name = studyTileName(tile);
  const auto loaded = loadTile(name);
  if (!loaded) return loaded.issue();
  const bool baked_before = std::filesystem::exists(folder / "bake.json");
  if (baked_before) {
    auto baked = BakedOutput::open(folder);
    if (!baked || serves(baked->manifest(), options, wanted, *loaded)) return baked;
  }
  BakeOptions bake_options;
  bake_options.size = options.size;
  bake_options.flat_size = wanted.flat_size;
  bake_options.supersample = wanted.supersample;
  bake_options.fill = wanted.fill;
  bake_options.texels = wanted.texels;
  bake_options.maps = wanted.maps;
  bake_options.threads = options.threads;
  bake_options.quiet = options.quiet;
  bake_options.resume = !baked_before;  // what stands there is of another tile or size
  if (wanted.some_views) bake_options.shards = options.every, bake_options.shard = options.every / 2;
  const auto report = bake(*loaded, name, folder, bake_options);
  if (!report) return report.issue();
  return wanted.some_views ? BakedOutput::unfinished(folder, report->manifest) : BakedOutput::open(folder);
}

namespace {

std::vector<std::string> columnsOf(const StudyRows& rows) {
  std::vector<std::string> columns;
  for (const StudyRow& row : rows)
    for (const auto& [key, value] : row.cells())
      if (std::find(columns.begin(), columns.end(), key) == columns.end()) columns.push_back(key);
  return columns;
}

std::string cellText(const StudyValue* value, const char* number_format) {
  if (!value) return {};
  if (const auto* text = std::get_if<std::string>(value)) return *text;
  if (const auto* integer = std::get_if<int64_t>(value)) return std::to_string(*integer);
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, number_format, std::get<double>(*value));
  return buffer;
}

std::string csvQuoted(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

}  // namespace

std::string studyJson(const Study& study, const std::string& command, const StudyRows& rows) {
  nlohmann::ordered_json json{{"schema", "loden/study/1"}, {"study", study.name}, {"command", command}};
  json["rows"] = nlohmann::ordered_json::array();
  for (const StudyRow& row : rows) {
    nlohmann::ordered_json object;
    for (const auto& [key, value] : row.cells())
      std::visit([&, &name = key](const auto& v) { object[name] = v; }, value);
    json["rows"].push_back(std::move(object));
  }
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) +
         "\n";  // paths need not be UTF-8
}

std::string studyCsv(const StudyRows& rows) {
  const auto columns = columnsOf(rows);
  std::string csv;
  const auto endCell = [&](size_t c) { csv += c + 1 < columns.size() ? "," : "\r\n"; };
  for (size_t c = 0; c < columns.size(); ++c) csv += csvQuoted(columns[c]), endCell(c);
  for (const StudyRow& row : rows)
    for (size_t c = 0; c < columns.size(); ++c)
      csv += csvQuoted(cellText(row.find(columns[c]), "%.9g")), endCell(c);
  return csv;
}

std::string studyTable(const StudyRows& rows) {
  const auto columns = columnsOf(rows);
  std::vector<std::vector<std::string>> lines{columns};
  for (const StudyRow& row : rows) {
    lines.emplace_back();
    for (const std::string& column : columns) lines.back().push_back(cellText(row.find(column), "%.5g"));
  }
  std::vector<size_t> widths(columns.size(), 0);
  for (const auto& line : lines)
    for (size_t c = 0; c < line.size(); ++c) widths[c] = std::max(widths[c], line[c].size());
  std::string text;
  for (const auto& line : lines) {
    for (size_t c = 0; c < line.size(); ++c) {
      text += line[c];
      if (c + 1 < line.size()) text.append(widths[c] - line[c].size() + 2, ' ');
    }
    text += '\n';
  }
  return text;
}

}  // namespace loden::importer
