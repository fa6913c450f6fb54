// Welkin for .NET and Unity: one file of C# 7.3 over the C interface, whose header (welkin/welkin.h) states the contract
// of each call. The shared library `welkin` must lie where the runtime finds it.
// Results are immutable and may be read from any thread. Calls that fail throw WelkinException. Handles may be disposed in
// any order and on any thread, also while another thread is in a call with them, which then ends first.
using System;
using System.Runtime.InteropServices;
using System.Text;

namespace Welkin {
  /// <summary>A call that failed: its status, and a message with the input, the fault and the remedy.</summary>
  public sealed class WelkinException : Exception {
    public int Status { get; }
    internal WelkinException(int status, string message) : base(message) { Status = status; }
  }

  /// <summary>The C interface: structures with the layouts of welkin.h, and functions.</summary>
  public static class Native {
    const string Library = "welkin";
    public const int NotReady = 101;

    [StructLayout(LayoutKind.Sequential)] public struct welkin_environment {
      public uint struct_size; public int format; public long row_stride_bytes;
      [MarshalAs(UnmanagedType.ByValArray, SizeConst = 6)] public IntPtr[] faces;
      public long size; public int width, height;
    }
    [StructLayout(LayoutKind.Sequential)] public struct welkin_projection_options {
      public uint struct_size; public int bands, midpoint, target_size; public IntPtr pixels;
    }
    [StructLayout(LayoutKind.Sequential)] public struct welkin_projection {
      public uint struct_size; public int bands;
      public ulong texels, nans_replaced, infinities_replaced, negatives_replaced, texels_clamped;
      [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] total_radiance_before_clamp;
      [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] total_radiance;
      public double error_estimate;
      [MarshalAs(UnmanagedType.ByValArray, SizeConst = 768)] public double[] coefficients;
    }
    [StructLayout(LayoutKind.Sequential)] public struct welkin_prefilter_options {
      public uint struct_size; public int size, mips, roughness_count; public IntPtr roughness; public int method;
      public double rms_error, maximum_error; public IntPtr pixels; public int lobe, spectrum_bands;
      public IntPtr spectra; public int quality; public IntPtr lobe_roughness; public int schedule, fitted;
    }
    [StructLayout(LayoutKind.Sequential)] public struct welkin_bake_options {
      public uint struct_size, leave_out;
      public int background_size, background_without_mips, background_box_filter, irradiance_size, irradiance_method,
        bands;
      public IntPtr specular, brdf, pixels; public ulong memory_limit_bytes; public double irradiance_rms_error;
      public int octahedral_size, octahedral_levels, octahedral_border, quality;
    }
    [StructLayout(LayoutKind.Sequential)] public struct welkin_chain_info {
      public uint struct_size; public int size, levels, prefiltered;
    }
    [StructLayout(LayoutKind.Sequential)] public struct welkin_atmosphere {
      public uint struct_size; public int planet, wavelength_count, absorber_count;
      public IntPtr wavelengths_nm, rayleigh, aerosol, aerosol_optics;
      public int aerosol_phase; public double aerosol_asymmetry; public IntPtr aerosol_asymmetries;
      [MarshalAs(UnmanagedType.ByValArray, SizeConst = 4)] public IntPtr[] absorbers;
      public double bottom_radius_m, top_radius_m; public IntPtr ground_albedo, sun_irradiance;
      public double sun_angular_radius_degrees, night_zenith_luminance;
    }
    [StructLayout(LayoutKind.Sequential)] public struct welkin_sky_table_options {
      public uint struct_size;
      public int compact, heights, view_zeniths, sun_zeniths, sun_angles, transmittance_heights, transmittance_zeniths,
        irradiance_heights, irradiance_sun_zeniths, orders, linear_srgb;
      public double minimum_sun_elevation_degrees, convergence_threshold; public ulong memory_limit_bytes;
      public int truncate_orders;
    }
    [StructLayout(LayoutKind.Sequential)] public struct welkin_sky_harmonics_options {
      public uint struct_size; public int bands, zeniths, azimuths, nodes;
    }
    [StructLayout(LayoutKind.Sequential)] public struct welkin_worker_options {
      public uint struct_size; public int threads, thread_priority; public IntPtr name, enqueue, enqueue_user;
      public ulong max_jobs, max_bytes;
    }

    [DllImport(Library)] internal static extern IntPtr welkin_last_error();
    [DllImport(Library)] internal static extern int welkin_project(ref welkin_environment mips, int count,
      ref welkin_projection_options options, IntPtr control, ref welkin_projection projection);
    [DllImport(Library)] internal static extern int welkin_bake(ref welkin_environment environment,
      ref welkin_bake_options options, IntPtr control, out IntPtr result);
    [DllImport(Library)] internal static extern IntPtr welkin_bake_result_chain(BakeResult result, uint part);
    [DllImport(Library)] internal static extern int welkin_bake_result_get_projection(BakeResult result,
      ref welkin_projection projection);
    [DllImport(Library)] internal static extern void welkin_bake_result_destroy(IntPtr result);
    [DllImport(Library)] internal static extern int welkin_chain_share(IntPtr chain, out IntPtr another);
    [DllImport(Library)] internal static extern int welkin_chain_get_info(Chain chain, ref welkin_chain_info info);
    [DllImport(Library)] internal static extern int welkin_chain_get_level(Chain chain, int level,
      ref welkin_environment pixels);
    [DllImport(Library)] internal static extern void welkin_chain_destroy(IntPtr chain);
    [DllImport(Library)] internal static extern int welkin_sun_direction(double elevation, double azimuth,
      [Out] double[] direction);
    [DllImport(Library)] internal static extern int welkin_sky_tables_create(ref welkin_atmosphere atmosphere,
      ref welkin_sky_table_options options, IntPtr control, out IntPtr tables);
    [DllImport(Library)] internal static extern void welkin_sky_tables_destroy(IntPtr tables);
    [DllImport(Library)] internal static extern int welkin_sky_view_create(SkyTables tables, double altitude,
      int without_ground, out IntPtr view);
    [DllImport(Library)] internal static extern void welkin_sky_view_destroy(IntPtr view);
    [DllImport(Library)] internal static extern int welkin_sky_curve_create(IntPtr view,
      ref welkin_sky_harmonics_options options, IntPtr control, out IntPtr curve);
    [DllImport(Library)] internal static extern int welkin_sky_curve_at(SkyCurve curve, double[] sun,
      [Out] double[] coefficients, [Out] double[] sun_irradiance);
    [DllImport(Library)] internal static extern void welkin_sky_curve_destroy(IntPtr curve);
    [DllImport(Library)] internal static extern int welkin_worker_create(ref welkin_worker_options options,
      out IntPtr worker);
    [DllImport(Library)] internal static extern void welkin_worker_destroy(IntPtr worker);
    [DllImport(Library)] internal static extern int welkin_post_bake(Worker worker, ref welkin_environment environment,
      ref welkin_bake_options options, IntPtr targets, IntPtr post, out IntPtr job);
    [DllImport(Library)] internal static extern int welkin_job_poll(BakeJob job, out double progress);
    [DllImport(Library)] internal static extern int welkin_job_wait(BakeJob job, ulong timeout);
    [DllImport(Library)] internal static extern int welkin_job_cancel(BakeJob job, out int cancelled);
    [DllImport(Library)] internal static extern int welkin_job_wait(IntPtr job, ulong timeout);
    [DllImport(Library)] internal static extern int welkin_job_cancel(IntPtr job, IntPtr cancelled);
    [DllImport(Library)] internal static extern int welkin_job_get_bake(BakeJob job, out IntPtr result);
    [DllImport(Library)] internal static extern void welkin_job_release(IntPtr job);

    internal static uint SizeOf<T>() { return (uint)Marshal.SizeOf(typeof(T)); }
    internal static void Check(int status) {
      if (status == 0) return;
      IntPtr text = welkin_last_error();
      int length = 0;
      while (Marshal.ReadByte(text, length) != 0) ++length;
      var bytes = new byte[length];
      Marshal.Copy(text, bytes, 0, length);
      throw new WelkinException(status, Encoding.UTF8.GetString(bytes));
    }
  }

  /// <summary>A handle that is destroyed once, by Dispose or by the garbage collector.</summary>
  public abstract class Handle : SafeHandle {
    internal Handle(IntPtr value) : base(IntPtr.Zero, true) { SetHandle(value); }
    public override bool IsInvalid { get { return handle == IntPtr.Zero; } }
  }

  /// <summary>Keeps what a handle owns while a call reads it through a bare pointer, until disposed.</summary>
  struct Hold : IDisposable {
    readonly SafeHandle handle;
    internal Hold(SafeHandle handle) {
      bool held = false;
      handle.DangerousAddRef(ref held);
      this.handle = handle;
    }
    public void Dispose() { handle.DangerousRelease(); }
  }

  /// <summary>Arrays that stay where they are until nothing holds them: neither a cubemap nor a call nor a job.</summary>
  sealed class Pins : Handle {
    readonly GCHandle[] pins;
    internal Pins(params float[][] arrays) : base(new IntPtr(1)) {
      pins = Array.ConvertAll(arrays, array => GCHandle.Alloc(array, GCHandleType.Pinned));
    }
    internal long Address(int array) { return pins[array].AddrOfPinnedObject().ToInt64(); }
    protected override bool ReleaseHandle() {
      foreach (GCHandle pin in pins) pin.Free();
      return true;
    }
  }

  /// <summary>Harmonics of radiance: r, g, b of coefficient (l, m) from 3 (l (l + 1) + m) on.</summary>
  public sealed class Projection {
    public int Bands { get; }
    public double ErrorEstimate { get; }
    public double[] Coefficients { get; }
    internal Projection(Native.welkin_projection from) {
      Bands = from.bands;
      ErrorEstimate = from.error_estimate;
      Coefficients = new double[3 * Bands * Bands];
      Array.Copy(from.coefficients, Coefficients, Coefficients.Length);
    }
  }

  /// <summary>A cubemap of packed RGB floats, faces +X -X +Y -Y +Z -Z, top rows first. Its pixels stay pinned until it is
  /// disposed or collected, and no job reads them any more.</summary>
  public sealed class Cubemap : IDisposable {
    readonly Pins pins;
    readonly int size, arrays;
    /// <summary>One array, face after face.</summary>
    public Cubemap(float[] pixels, int size) : this(size, pixels) { }
    /// <summary>An array per face, as one array is too short for 18 size^2 floats from size 10 923 on.</summary>
    public Cubemap(float[][] faces, int size) : this(size, faces) {
      if (arrays != 6) throw new ArgumentException("a cubemap has six faces");
    }
    Cubemap(int size, params float[][] arrays) {
      if (arrays == null || arrays.Length == 0) throw new ArgumentNullException("faces");
      this.size = size;
      this.arrays = arrays.Length;
      double each = 18.0 * size * size / arrays.Length;  // exact as far as an array reaches
      foreach (float[] array in arrays) {
        if (size < 1 || array == null || array.LongLength != each) {
          throw new ArgumentException("a cubemap has 3 size^2 floats per face");
        }
      }
      pins = new Pins(arrays);
    }
    public void Dispose() { pins.Dispose(); }
    /// <summary>Keeps the pixels, also if the cubemap is disposed meanwhile.</summary>
    internal Hold Hold() { return new Hold(pins); }
    /// <summary>The pixels, for as long as they are held.</summary>
    internal Native.welkin_environment View() {
      var faces = new IntPtr[6];
      for (int face = 0; face < 6; ++face) {
        long inside = arrays == 6 ? 0 : 12L * size * size * face;
        faces[face] = new IntPtr(pins.Address(arrays == 6 ? face : 0) + inside);
      }
      return new Native.welkin_environment {
        struct_size = Native.SizeOf<Native.welkin_environment>(), faces = faces, size = size };
    }
    /// <summary>Projects the cubemap to 1 to 16 bands of harmonics.</summary>
    public Projection Project(int bands = 3) {
      var options = new Native.welkin_projection_options {
        struct_size = Native.SizeOf<Native.welkin_projection_options>(), bands = bands };
      var light = new Native.welkin_projection { struct_size = Native.SizeOf<Native.welkin_projection>() };
      using (Hold()) {
        var view = View();
        Native.Check(Native.welkin_project(ref view, 1, ref options, IntPtr.Zero, ref light));
      }
      return new Projection(light);
    }
    /// <summary>Bakes background, reflections, irradiance, harmonics and the BRDF table.</summary>
    public BakeResult Bake(int size = 0) {
      IntPtr result = IntPtr.Zero;
      using (Hold()) {
        var view = View();
        WithOptions(size, options => Native.Check(Native.welkin_bake(ref view, ref options, IntPtr.Zero, out result)));
      }
      return new BakeResult(result);
    }
    internal static void WithOptions(int size, Action<Native.welkin_bake_options> call) {
      var specular = new Native.welkin_prefilter_options {
        struct_size = Native.SizeOf<Native.welkin_prefilter_options>(), size = size };
      IntPtr memory = Marshal.AllocHGlobal((int)specular.struct_size);
      try {
        Marshal.StructureToPtr(specular, memory, false);
        call(new Native.welkin_bake_options {
          struct_size = Native.SizeOf<Native.welkin_bake_options>(), specular = memory });
      } finally {
        Marshal.FreeHGlobal(memory);
      }
    }
  }

  /// <summary>Result of a bake.</summary>
  public sealed class BakeResult : Handle {
    internal BakeResult(IntPtr value) : base(value) { }
    protected override bool ReleaseHandle() { Native.welkin_bake_result_destroy(handle); return true; }
    public Chain Background { get { return Part(1); } }
    public Chain Specular { get { return Part(2); } }
    public Chain Irradiance { get { return Part(4); } }
    public Projection Radiance {
      get {
        var light = new Native.welkin_projection { struct_size = Native.SizeOf<Native.welkin_projection>() };
        Native.Check(Native.welkin_bake_result_get_projection(this, ref light));
        return new Projection(light);
      }
    }
    Chain Part(uint part) {
      using (new Hold(this)) {  // the result's chain goes with the result
        IntPtr shared;
        Native.Check(Native.welkin_chain_share(Native.welkin_bake_result_chain(this, part), out shared));
        return new Chain(shared);
      }
    }
  }

  /// <summary>A cubemap with its mips; level l has max(1, Size >> l) texels per edge.</summary>
  public sealed class Chain : Handle {
    public int Size { get; }
    public int Levels { get; }
    internal Chain(IntPtr value) : base(value) {
      var info = new Native.welkin_chain_info { struct_size = Native.SizeOf<Native.welkin_chain_info>() };
      Native.Check(Native.welkin_chain_get_info(this, ref info));
      Size = info.size;
      Levels = info.levels;
    }
    protected override bool ReleaseHandle() { Native.welkin_chain_destroy(handle); return true; }
    /// <summary>Copies a face of a level: packed RGB, top row first.</summary>
    public float[] Face(int level, int face) {
      if (face < 0 || face > 5) throw new ArgumentOutOfRangeException("face");
      var pixels = new Native.welkin_environment { struct_size = Native.SizeOf<Native.welkin_environment>() };
      using (new Hold(this)) {  // so do the pixels with the chain
        Native.Check(Native.welkin_chain_get_level(this, level, ref pixels));
        var values = new float[3 * pixels.size * pixels.size];
        Marshal.Copy(pixels.faces[face], values, 0, values.Length);
        return values;
      }
    }
  }

  /// <summary>Atmospheres to start from; welkin.h describes them.</summary>
  public enum Planet { Earth, EarthHillaire, Mars, Bare, EarthBruneton, EarthHazy, EarthDusty, EarthPolluted }

  /// <summary>Precomputed scattering of a planet's atmosphere.</summary>
  public sealed class SkyTables : Handle {
    /// <summary>Computes tables: 2 to 3 s of CPU time with the defaults.</summary>
    public SkyTables(Planet planet = Planet.Earth,
                     Native.welkin_sky_table_options options = default(Native.welkin_sky_table_options))
      : base(Create(planet, options)) { }
    static IntPtr Create(Planet planet, Native.welkin_sky_table_options options) {
      IntPtr tables;
      var atmosphere = new Native.welkin_atmosphere {
        struct_size = Native.SizeOf<Native.welkin_atmosphere>(), planet = (int)planet };
      options.struct_size = Native.SizeOf<Native.welkin_sky_table_options>();
      Native.Check(Native.welkin_sky_tables_create(ref atmosphere, ref options, IntPtr.Zero, out tables));
      return tables;
    }
    protected override bool ReleaseHandle() { Native.welkin_sky_tables_destroy(handle); return true; }
  }

  /// <summary>Harmonics of the sky from one altitude, for any sun.</summary>
  public sealed class SkyCurve : Handle {
    readonly int bands;
    public SkyCurve(SkyTables tables, double altitudeMetres, int bands = 3, int nodes = 0)
      : base(Create(tables, altitudeMetres, bands, nodes)) { this.bands = bands; }
    static IntPtr Create(SkyTables tables, double altitude, int bands, int nodes) {
      IntPtr view, curve;
      if (tables == null) throw new ArgumentNullException("tables");
      Native.Check(Native.welkin_sky_view_create(tables, altitude, 0, out view));
      try {
        if (bands < 1) throw new ArgumentOutOfRangeException("bands");
        var options = new Native.welkin_sky_harmonics_options {
          struct_size = Native.SizeOf<Native.welkin_sky_harmonics_options>(), bands = bands, nodes = nodes };
        Native.Check(Native.welkin_sky_curve_create(view, ref options, IntPtr.Zero, out curve));
        return curve;
      } finally {
        Native.welkin_sky_view_destroy(view);
      }
    }
    /// <summary>Computes radiance without the sun's disc, and direct sunlight on a surface facing the sun.</summary>
    public double[] At(double elevationDegrees, double azimuthDegrees, out double[] sunIrradiance) {
      var sun = new double[3];
      var coefficients = new double[3 * bands * bands];
      sunIrradiance = new double[3];
      Native.Check(Native.welkin_sun_direction(elevationDegrees, azimuthDegrees, sun));
      Native.Check(Native.welkin_sky_curve_at(this, sun, coefficients, sunIrradiance));
      return coefficients;
    }
    protected override bool ReleaseHandle() { Native.welkin_sky_curve_destroy(handle); return true; }
  }

  /// <summary>Bakes on threads of its own. Dispose cancels all jobs and waits for them.</summary>
  public sealed class Worker : Handle {
    public Worker(int threads = 0) : base(Create(threads)) { }
    static IntPtr Create(int threads) {
      IntPtr worker;
      var options = new Native.welkin_worker_options {
        struct_size = Native.SizeOf<Native.welkin_worker_options>(), threads = threads };
      Native.Check(Native.welkin_worker_create(ref options, out worker));
      return worker;
    }
    /// <summary>Posts a bake. The job keeps the pixels, which must not change before it is ready.</summary>
    public BakeJob PostBake(Cubemap cubemap, int size = 0) {
      if (cubemap == null) throw new ArgumentNullException("cubemap");
      Hold pixels = cubemap.Hold();
      IntPtr job = IntPtr.Zero;
      try {
        var view = cubemap.View();
        Cubemap.WithOptions(size, options => Native.Check(
          Native.welkin_post_bake(this, ref view, ref options, IntPtr.Zero, IntPtr.Zero, out job)));
        return new BakeJob(job, this, pixels);
      } catch {
        pixels.Dispose();
        throw;
      }
    }
    protected override bool ReleaseHandle() { Native.welkin_worker_destroy(handle); return true; }
  }

  /// <summary>A posted bake. Nobody can ask for its result once it is disposed or collected, so that cancels it, and waits
  /// until it reads no pixel any more: a tile of the work.</summary>
  public sealed class BakeJob : Handle {
    readonly Hold pixels;
    /// <summary>Where it was posted: held, so that it is not collected, which would stop the job.</summary>
    public Worker Worker { get; }
    internal BakeJob(IntPtr value, Worker worker, Hold pixels) : base(value) {
      Worker = worker;
      this.pixels = pixels;
    }
    /// <summary>Returns true once the job is ready; throws if it failed. Never waits.</summary>
    public bool Poll(out double progress) {
      int status = Native.welkin_job_poll(this, out progress);
      if (status == Native.NotReady) return false;
      Native.Check(status);
      return true;
    }
    public void Wait() { Native.Check(Native.welkin_job_wait(this, ulong.MaxValue)); }
    public void Cancel() { int cancelled; Native.Check(Native.welkin_job_cancel(this, out cancelled)); }
    /// <summary>Returns the result of a job that is ready.</summary>
    public BakeResult Result() {
      IntPtr result;
      int status = Native.welkin_job_get_bake(this, out result);
      if (status == Native.NotReady) throw new InvalidOperationException("the job is not ready");
      Native.Check(status);
      return new BakeResult(result);
    }
    // In finalizers the worker may be gone already: its jobs are ready then, and the pixels are counted, not collected.
    protected override bool ReleaseHandle() {
      Native.welkin_job_cancel(handle, IntPtr.Zero);
      Native.welkin_job_wait(handle, ulong.MaxValue);
      Native.welkin_job_release(handle);
      pixels.Dispose();
      return true;
    }
  }
}
