// Modules in workers, as `type: "module"` says; the default of Vite cannot split code.
export default { base: "./", build: { target: "es2022", outDir: "dist-vite" }, worker: { format: "es" } };
