#include "sample_game/film.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <vector>

#include "material/base/issues.h"

extern char** environ;

namespace loden::walk {

Result<bool> encodeFilm(const std::filesystem::path& folder, const std::filesystem::path& film,
                        int frames_per_second) {
  constexpr int kNotThere = 127;  // what a shell says, and some spawns do
  // Sides must be even for the pixel format that every player takes.
  std::vector<std::string> words{"ffmpeg",     "-y",
                                 "-loglevel",  "error",
                                 "-framerate", std::to_string(frames_per_second),
                                 "-i",         (folder / "frame_%04d.png").string(),
                                 "-vf",        "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                                 "-pix_fmt",   "yuv420p",
                                 "-movflags",  "+faststart",
                                 film.string()};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  pid_t child = 0;
  const int failed = posix_spawnp(&child, "ffmpeg", &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) return false;
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNotThere) return false;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return true;
  return Issue{issue_id::kCannotWrite, Severity::kError, film.string(),
               "ffmpeg could not make it of the frames beside it, which are complete"};
}

}  // namespace loden::walk
