// A plugin for qemu-user that prints, when a program ends, how many instructions it has executed.
//
// Debian ships no qemu-plugin.h; these are the declarations of QEMU 7.2's that are used here ("TCG Plugins" in its
// documentation), which plugin version 1 keeps stable.
#include <cstddef>
#include <cstdint>
#include <string>

extern "C" {
using PluginId = std::uint64_t;
struct qemu_plugin_tb;
enum InlineOperation { inline_add_u64 };

[[gnu::visibility("default")]] extern const int qemu_plugin_version;
[[gnu::visibility("default")]] int qemu_plugin_install(PluginId id, const void* info, int argc, char** argv);

void qemu_plugin_register_vcpu_tb_trans_cb(PluginId id, void (*callback)(PluginId, qemu_plugin_tb*));
void qemu_plugin_register_vcpu_tb_exec_inline(qemu_plugin_tb* block, InlineOperation operation, void* counter,
                                              std::uint64_t amount);
void qemu_plugin_register_atexit_cb(PluginId id, void (*callback)(PluginId, void*), void* data);
std::size_t qemu_plugin_tb_n_insns(const qemu_plugin_tb* block);
void qemu_plugin_outs(const char* text);
}

const int qemu_plugin_version = 1;

namespace {

std::uint64_t executed = 0;

void count_block(PluginId, qemu_plugin_tb* block) {
  qemu_plugin_register_vcpu_tb_exec_inline(block, inline_add_u64, &executed, qemu_plugin_tb_n_insns(block));
}

void print(PluginId, void*) {
  qemu_plugin_outs(("instructions: " + std::to_string(executed) + "\n").c_str());
}

}  // namespace

int qemu_plugin_install(PluginId id, const void*, int, char**) {
  qemu_plugin_register_vcpu_tb_trans_cb(id, count_block);
  qemu_plugin_register_atexit_cb(id, print, nullptr);
  return 0;
}
