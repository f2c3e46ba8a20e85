// SPDX-License-Identifier: Apache-2.0
import react from '@vitejs/plugin-react';
import { defineConfig } from 'vitest/config';

export default defineConfig({
  plugins: [react()],
  build: {
    target: 'es2021',
    modulePreload: { polyfill: false },
    assetsInlineLimit: 0, // the content security policy allows files of the page only
    emptyOutDir: true,
    chunkSizeWarningLimit: 2000,
  },
  test: { include: ['src/**/*.test.ts'], testTimeout: 120_000 },
});
