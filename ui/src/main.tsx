// SPDX-License-Identifier: Apache-2.0
import { StrictMode } from 'react';
import { createRoot } from 'react-dom/client';
import { App } from './App';
import { Connection } from './robot/connection';
import { ConnectionContext } from './robot/hooks';
import { keepKey } from './robot/key';
import './style.css';

keepKey();
const connection = new Connection(window.location.origin.replace(/^http/, 'ws') + '/socket');
connection.start();

const root = document.getElementById('root');
if (root) {
  createRoot(root).render(
    <StrictMode>
      <ConnectionContext value={connection}>
        <App />
      </ConnectionContext>
    </StrictMode>,
  );
}
