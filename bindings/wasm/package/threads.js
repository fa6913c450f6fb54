// Threads of one module: workers with instances of it on one memory. The module's C library makes a thread in memory
// and names it to `__pthread_create_js`; here it is noted and then started, before any call, as a worker starts no
// workers while it computes. No thread ever ends.

const kPages = { initial: 256, maximum: 32768, shared: true }; // as bindings/wasm/CMakeLists.txt says
const kStackBytes = 1 << 20;
/** Offsets in the C library's `struct pthread`, Emscripten 3.1.6. */
const kStack = 44;
const kStackSize = 48;

/** What a module with threads imports of a system; `asked` takes the threads that it makes. */
function importsFor(module, memory, progress, asked) {
  const env = {
    memory,
    emscripten_get_now: () => performance.timeOrigin + performance.now(),
    clock_gettime: (_clock, place) => {
      const now = performance.timeOrigin + performance.now();
      const view = new DataView(memory.buffer);
      view.setInt32(place, Math.floor(now / 1000), true);
      view.setInt32(place + 4, Math.floor((now % 1000) * 1e6), true);
      return 0;
    },
    emscripten_memcpy_big: (to, from, bytes) => {
      new Uint8Array(memory.buffer).copyWithin(to >>> 0, from >>> 0, (from >>> 0) + (bytes >>> 0));
    },
    emscripten_resize_heap: (bytes) => {
      try {
        memory.grow(Math.max(0, Math.ceil(((bytes >>> 0) - memory.buffer.byteLength) / 65536)));
        return 1;
      } catch {
        return 0;
      }
    },
    emscripten_get_heap_max: () => kPages.maximum * 65536,
    emscripten_num_logical_cores: () => 1,
    _emscripten_default_pthread_stack_size: () => kStackBytes,
    __pthread_create_js: (block, _attributes, entry, argument) => {
      asked.push({ block, entry, argument });
      return 0;
    },
    __syscall_stat64: () => -52, // ENOSYS: there are no files
    abort: () => {
      throw new Error('the module ended itself');
    },
  };
  const noVariables = (count, bytes) => {
    for (const place of [count, bytes]) new DataView(memory.buffer).setUint32(place, 0, true);
    return 0;
  };
  const imports = { env, welkin: { progress }, wasi_snapshot_preview1: { environ_sizes_get: noVariables } };
  for (const { module: space, name } of WebAssembly.Module.imports(module)) {
    imports[space] ??= {};
    imports[space][name] ??= () => 0;
  }
  return imports;
}

/** The exports of an instance with so many threads, its memory, and a way to end them. `makeThread(data)` resolves to a
 * worker whose thread waits for work. */
export async function instanceWithThreads(module, progress, count, makeThread) {
  const memory = new WebAssembly.Memory(kPages);
  const asked = [];
  const imports = importsFor(module, memory, progress, asked);
  let exports;
  imports.env.__emscripten_init_main_thread_js = (block) => exports._emscripten_thread_init(block, 0, 1, 1);
  exports = new WebAssembly.Instance(module, imports).exports;
  exports.__wasm_call_ctors();
  exports.welkin_make_threads(count);
  const threads = await Promise.all(asked.map((thread) => makeThread({ module, memory, thread })));
  return { exports, memory, stop: () => threads.forEach((thread) => thread.terminate()) };
}

/** What a worker does that is a thread: never returns. */
export function runThread({ module, memory, thread }, ready) {
  const { exports } = new WebAssembly.Instance(module, importsFor(module, memory, () => {}, []));
  exports._emscripten_thread_init(thread.block, 0, 0, 1);
  const block = new DataView(memory.buffer, thread.block);
  const top = block.getUint32(kStack, true);
  exports.emscripten_stack_set_limits(top, top - block.getUint32(kStackSize, true));
  exports.stackRestore(top);
  exports.emscripten_tls_init();
  ready();
  exports.__indirect_function_table.get(thread.entry)(thread.argument);
}
