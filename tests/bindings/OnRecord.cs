// Results through Welkin.cs have the bits on record: OnRecord.exe core_hashes.txt, with C's sizes on standard input.
using System;
using System.IO;
using System.Linq;
using System.Runtime.InteropServices;
using Welkin;

static class OnRecord {
  static string[] record;
  static int failures;

  static void Expect(bool holds, string what) {
    if (holds) return;
    Console.WriteLine("failed: " + what);
    ++failures;
  }
  static void Recorded(string name, params double[][] results) {
    ulong hash = 0xcbf29ce484222325;
    foreach (double[] values in results)
      foreach (double value in values)
        foreach (byte part in BitConverter.GetBytes(value)) hash = unchecked((hash ^ part) * 0x100000001b3);
    string line = name + " " + hash.ToString("x16");
    Expect(record.Contains(line), line);
  }
  static float[] Radiances(int count, ulong seed) {
    ulong state = seed * 2 + 1;
    Func<uint> bits = () => {
      state = unchecked(state * 6364136223846793005 + 1442695040888963407);
      return (uint)(state >> 33);
    };
    var values = new float[count];
    for (int k = 0; k < count; ++k) {
      values[k] = (bits() & 0xFFFFFF) / 16777216.0f;
      if (bits() % 509 == 0) values[k] *= 700.0f;
    }
    return values;
  }
  static void Lifetimes() {
    var pixels = Radiances(18 * 64 * 64, 10);
    var faces = Enumerable.Range(0, 6).Select(face => pixels.Skip(face * 3 * 64 * 64).Take(3 * 64 * 64).ToArray()).ToArray();
    using (var one = new Cubemap(pixels, 64))
    using (var six = new Cubemap(faces, 64))
      Expect(one.Project().Coefficients.SequenceEqual(six.Project().Coefficients), "six arrays are one");
    foreach (var refused in new Action[] { () => new Cubemap(new float[17], 1), () => new Cubemap(new float[5][], 1),
                                           () => new Cubemap(new float[18], 1 << 30) }) {
      try { refused(); Expect(false, "a wrong length is refused"); } catch (ArgumentException) { }
    }
    using (var worker = new Worker(1)) {
      var cubemap = new Cubemap(pixels, 64);
      using (var job = worker.PostBake(cubemap, 64)) {
        cubemap.Dispose();  // while the job reads its pixels
        job.Wait();
        using (var result = job.Result()) Expect(result.Radiance.Bands == 3, "the job kept the pixels");
      }
      try { cubemap.Project(); Expect(false, "a disposed cubemap is refused"); } catch (ObjectDisposedException) { }
      worker.PostBake(new Cubemap(pixels, 64), 64).Dispose();  // while it waits or runs
    }
    // Left to the collector in every order, in the middle of the work.
    for (int round = 0; round < 20; ++round) {
      Leave(pixels);
      GC.Collect();
      GC.WaitForPendingFinalizers();
    }
  }
  static void Leave(float[] pixels) {
    var worker = new Worker(2);
    var jobs = Enumerable.Range(0, 4).Select(job => worker.PostBake(new Cubemap((float[])pixels.Clone(), 64), 32)).ToArray();
    jobs[0].Wait();
    var chain = jobs[0].Result().Specular;
    GC.Collect();
    GC.WaitForPendingFinalizers();
    Expect(chain.Face(0, 0).Length == 3 * 32 * 32, "a chain outlives its result");
  }
  static int Main(string[] arguments) {
    record = File.ReadAllLines(arguments[0]);
    for (string line; (line = Console.ReadLine()) != null;) {
      string[] words = line.Split(' ');  // structure [field] number
      Type type = typeof(Native).GetNestedType(words[0]);
      long found = words.Length == 2 ? Marshal.SizeOf(type) : Marshal.OffsetOf(type, words[1]).ToInt64();
      Expect(found == long.Parse(words[words.Length - 1]), line + ", not " + found);
    }
    foreach (int size in new[] {7, 64, 257})
      using (var cubemap = new Cubemap(Radiances(18 * size * size, 1), size))
        Recorded("project/cubemap_" + size + "_bands_3", cubemap.Project().Coefficients);
    using (var cubemap = new Cubemap(Radiances(18 * 64 * 64, 10), 64))
    using (var worker = new Worker(1))
    using (var job = worker.PostBake(cubemap, 64)) {
      job.Wait();
      using (var posted = job.Result())
      using (var called = cubemap.Bake(64))
      using (var one = posted.Specular)
      using (var two = called.Specular) {
        var texels = Enumerable.Range(0, one.Levels).SelectMany(level => Enumerable.Range(0, 6).SelectMany(
          face => one.Face(level, face).Select(value => (double)value))).ToArray();
        Recorded("prefilter/cubemap_64", texels);
        Expect(one.Face(1, 3).SequenceEqual(two.Face(1, 3)), "a posted bake is a called one");
      }
    }
    using (var tables = new SkyTables(Planet.Earth, new Native.welkin_sky_table_options {
      heights = 5, view_zeniths = 16, sun_zeniths = 16, sun_angles = 4, transmittance_heights = 16,
      transmittance_zeniths = 64, irradiance_heights = 4, irradiance_sun_zeniths = 16, orders = 3 }))
    using (var curve = new SkyCurve(tables, 200, 3, 32)) {
      double[] sun;
      double[] light = curve.At(10, 30, out sun);
      Recorded("sky/curve", light, sun);
    }
    try {
      using (var cubemap = new Cubemap(new float[18], 1)) cubemap.Project(17);
      Expect(false, "17 bands are refused");
    } catch (WelkinException error) {
      Expect(error.Status == 1 && error.Message.Contains("17"), error.Message);
    }
    Lifetimes();
    return failures;
  }
}
